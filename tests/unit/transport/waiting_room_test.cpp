// Who is next, and who has to go.
#include "waiting_room.hpp"

#include <doctest/doctest.h>

#include <fcntl.h>

using hive::transport::Descriptor, hive::transport::WaitingRoom;

namespace {

Descriptor something() { return Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC)); }

}  // namespace

TEST_CASE("waiting room: each host has its turn, and of one host whoever came first")
{
    WaitingRoom room;
    int first = -1;
    for (const auto* host : {"many", "many", "many", "few", "one"}) {
        auto socket = something();
        first = first < 0 ? socket.get() : first;
        room.enter({host, std::move(socket)});
    }
    std::string turns;
    bool was_first = false;
    while (!room.empty()) {
        const auto peer = room.next();
        was_first = was_first || (turns.find("many") == std::string::npos && peer.socket.get() == first);
        turns += peer.host + " ";
    }
    CHECK(turns == "few many one many many ");
    CHECK(was_first);
}

TEST_CASE("waiting room: a host alone fills it and loses nobody; for another host the last of the many goes")
{
    WaitingRoom room;
    while (!room.full())
        room.enter({"many", something()});
    room.enter({"few", something()});
    room.enter({"few", something()});
    CHECK(room.full());
    std::size_t many = 0, few = 0;
    while (!room.empty())
        ++(room.next().host == "many" ? many : few);
    CHECK(few == 2);
    CHECK(many == WaitingRoom::most - 1);
    CHECK_FALSE(room.full());
}
