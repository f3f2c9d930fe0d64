// Who is next, and who has to go.
#include "waiting_room.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <list>
#include <sys/socket.h>
#include <unistd.h>

using hive::transport::Descriptor, hive::transport::WaitingRoom;

namespace {

struct Pair {
    Pair()
    {
        int ends[2] = {-1, -1};
        REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0);
        here = Descriptor(ends[0]);
        there = Descriptor(ends[1]);
    }
    void speak() const { REQUIRE(::write(there.get(), "x", 1) == 1); }
    Descriptor here, there;
};

/// The other end has left, which counts as having spoken.
Descriptor something() { return std::move(Pair().here); }

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

TEST_CASE("waiting room: who has spoken comes before all who are silent, whenever they came")
{
    WaitingRoom room;
    std::list<Pair> pairs(20);
    int i = 0;
    for (auto& pair : pairs)
        room.enter({"host " + std::to_string(i++), std::move(pair.here)});
    CHECK_FALSE(room.spoken());
    std::next(pairs.begin(), 13)->speak();
    CHECK(room.spoken());
    CHECK(room.next().host == "host 13");
    CHECK_FALSE(room.spoken());
    room.next();
}

TEST_CASE(
    "waiting room: when silent peers fill it, the one that has been silent for longest goes; who has spoken stays")
{
    WaitingRoom room;
    std::list<Pair> pairs(3 * WaitingRoom::most);
    pairs.front().speak();
    int i = 0;
    for (auto& pair : pairs) {
        room.enter({"host " + std::to_string(i++), std::move(pair.here)});
        CHECK_FALSE(room.full());
    }
    const auto went = [](const Pair& pair) {
        char byte = 0;
        return ::recv(pair.there.get(), &byte, 1, MSG_DONTWAIT) == 0;
    };
    CHECK_FALSE(went(pairs.front()));
    CHECK(went(*std::next(pairs.begin(), 1)));
    CHECK_FALSE(went(pairs.back()));
    CHECK(static_cast<std::size_t>(std::ranges::count_if(pairs, went)) == 2 * WaitingRoom::most);
    CHECK(room.next().host == "host 0");
}
