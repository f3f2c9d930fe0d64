// Bodies in shared memory over a unix socket: same bytes, slots that come back, nobody who can starve the others.
#include "transport_world.hpp"

#include <hive/transport/pool.hpp>

#include <cstring>

using namespace world;
using hive::Body;
using hive::transport::Carriage;
using hive::transport::Pool;

namespace {

constexpr std::size_t image = 1u << 20;

struct SharingPair : Pair {
    std::shared_ptr<Pool> pool = std::make_shared<Pool>(Pool::Limits{.bytes = 256u << 20, .segment_bytes = 8u << 20});

    SharingPair() : Pair(Unix::address, patient) { dialing.connection->share(pool); }
    ~SharingPair() { pool->end(); }
    SharingPair(const SharingPair&) = delete;
    SharingPair& operator=(const SharingPair&) = delete;

    Body filled(int with, std::size_t size = image)
    {
        auto loan = pool->loan(size);
        REQUIRE(loan);
        std::memset(loan->data(), with, loan->size());
        return std::move(*loan);
    }
    Carriage send(Body body)
    {
        return dialing.connection->send(hive::protocol::make_packet(PacketType::event, "{}", 3, std::move(body)));
    }
    /// What the listening end has got, taken from it.
    std::vector<Body> received(std::size_t count)
    {
        REQUIRE(loop.until([&] { return listening.has(count); }));
        std::vector<Body> bodies;
        for (auto& packet : listening.packets) {
            CHECK(packet.type == PacketType::event);
            CHECK(packet.channel == 3);
            bodies.push_back(std::move(packet.body));
        }
        listening.packets.clear();
        return bodies;
    }
    bool until_in_use(std::size_t slots)
    {
        return loop.until([&] { return pool->usage().slots_in_use == slots; }, 5s);
    }
};

}  // namespace

TEST_CASE("shared memory: only unix sockets can share")
{
    CHECK(Pair(Unix::address, patient).dialing.connection->can_share());
    CHECK_FALSE(Pair(Tcp::address, patient).dialing.connection->can_share());
}

TEST_CASE("shared memory: a body arrives with its bytes and without being copied, and its slot comes back when it ends")
{
    SharingPair pair;
    CHECK(pair.send(pair.filled(42)) == Carriage::reference);
    auto bodies = pair.received(1);
    REQUIRE(bodies[0].size() == image);
    CHECK(bodies[0].foreign());
    CHECK(std::ranges::all_of(bodies[0].bytes(), [](std::byte byte) { return byte == std::byte{42}; }));
    CHECK(pair.pool->usage().slots_in_use == 1);
    bodies.clear();
    CHECK(pair.until_in_use(0));
}

TEST_CASE("shared memory: a part of a slot, a small body and one of ordinary memory all arrive")
{
    SharingPair pair;
    auto loan = pair.pool->loan(image);
    std::memset(loan->data(), 5, image);
    CHECK(pair.send(std::move(*loan).body(9999)) == Carriage::reference);
    CHECK(pair.send(std::string(100, 'a')) == Carriage::inside);
    CHECK(pair.send(std::string(image, 'b')) == Carriage::fallback);
    const auto bodies = pair.received(3);
    CHECK(bodies[0].size() == 9999);
    CHECK(bodies[0].data()[9998] == 5);
    CHECK(bodies[1].data()[99] == 'a');
    CHECK_FALSE(bodies[1].foreign());
    CHECK(bodies[2].size() == image);
    CHECK(bodies[2].data()[image - 1] == 'b');
}

TEST_CASE("shared memory: bodies by reference and in packets keep their order, and neither counts as control")
{
    SharingPair pair;
    constexpr int count = 200;
    const std::string long_header = "{\"fill\":\"" + std::string(4000, 'x') + "\"}";
    for (int i = 0; i < count; ++i)  // nothing is written before the loop runs; of references alone this is 400 KB
        pair.dialing.connection->send(
            hive::protocol::make_packet(PacketType::event, i % 2 ? long_header : "{}", 3,
                                        i % 2 ? pair.filled(i, 5000) : Body(std::string(5000, static_cast<char>(i)))));
    const auto bodies = pair.received(count);
    CHECK(pair.dialing.closed == 0);
    for (int i = 0; i < count; ++i) {
        CAPTURE(i);
        CHECK(std::to_integer<int>(bodies[static_cast<std::size_t>(i)].bytes()[0]) == i % 256);
    }
}

TEST_CASE("shared memory: two thousand images through eight slots, all intact and none lost")
{
    SharingPair pair;
    constexpr int count = 2000;
    int sent = 0, arrived = 0, wrong = 0, shared = 0;
    pair.listening.on_packet = [&](const Packet& packet) {
        const auto* bytes = packet.body.data();
        wrong +=
            bytes[0] != arrived % 256 || bytes[image / 2] != arrived % 256 || bytes[image - 1] != arrived % 256 ? 1 : 0;
        ++arrived;
    };
    while (arrived < count) {
        while (sent < count && pair.pool->usage().slots_in_use < 4) {
            shared += pair.send(pair.filled(sent % 256)) == Carriage::reference ? 1 : 0;
            ++sent;
        }
        REQUIRE(
            pair.loop.until([&] { return !pair.listening.packets.empty() || pair.pool->usage().slots_in_use < 4; }));
        pair.listening.packets.clear();
    }
    CHECK(wrong == 0);
    CHECK(shared == count);
    CHECK(pair.until_in_use(0));
}

TEST_CASE(
    "shared memory: a receiver that keeps every slot gets the rest through the socket, and leaves some for the others")
{
    SharingPair hoarder;
    std::vector<Body> hoard;
    int shared = 0;
    for (int i = 0; i < 30; ++i) {
        auto loan = hoarder.pool->loan(image);
        REQUIRE(loan);  // the producer is never without
        std::memset(loan->data(), i, image);
        shared += hoarder.send(std::move(*loan)) == Carriage::reference ? 1 : 0;
        for (auto& body : hoarder.received(1))
            hoard.push_back(std::move(body));
    }
    CHECK(shared == 6);  // of 8 slots
    for (int i = 0; i < 30; ++i)
        CHECK(hoard[static_cast<std::size_t>(i)].data()[image - 1] == i);
    hoard.clear();
    CHECK(hoarder.until_in_use(0));
    CHECK(hoarder.send(hoarder.filled(1)) == Carriage::reference);
}

TEST_CASE("shared memory: slots come back when the receiver's end closes, and what it still holds becomes its own")
{
    SharingPair pair;
    pair.send(pair.filled(1));
    pair.send(pair.filled(2));
    const auto bodies = pair.received(2);
    pair.listening.connection->close(hive::Error(Errc::stopped, "enough"));
    REQUIRE(pair.loop.until([&] { return pair.dialing.closed == 1; }));
    CHECK(pair.until_in_use(0));
    std::vector<Body> overwriting{pair.filled(99), pair.filled(99)};
    CHECK(bodies[0].data()[image / 2] == 1);
    CHECK(bodies[1].data()[image / 2] == 2);
}

TEST_CASE("shared memory: who cuts a peer off leaves it its slots for a while")
{
    SharingPair pair;
    pair.send(pair.filled(1));
    const auto bodies = pair.received(1);
    pair.dialing.connection->close(hive::Error(Errc::timeout, "it was silent"));
    REQUIRE(pair.loop.until([&] { return pair.listening.closed == 1; }));
    CHECK(pair.pool->usage().slots_in_use == 1);
    pair.pool->end();
    CHECK(pair.pool->usage().slots_in_use == 0);
    CHECK(bodies[0].data()[0] == 1);
}

TEST_CASE("shared memory: a body that goes out twice on one connection comes back only after both")
{
    SharingPair pair;
    {
        const auto body = pair.filled(8);
        pair.send(body);
        pair.send(body);
    }
    auto bodies = pair.received(2);
    CHECK(bodies[0].data() == bodies[1].data());
    bodies.pop_back();
    pair.loop.run_for(50ms);
    CHECK(pair.pool->usage().slots_in_use == 1);
    bodies.pop_back();
    CHECK(pair.until_in_use(0));
}
