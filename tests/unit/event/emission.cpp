// Events as packets and back.
#include "fixtures.hpp"

#include <hive/error.hpp>

#include <doctest/doctest.h>

namespace hive::event {

using protocol::PacketType;

TEST_CASE("emission: what is sent is what arrives")
{
    Event event = emission(42, true)->event();
    event.identity.captured_us = 1'700'000'000'000'000;
    event.identity.monotonic_us = 123;
    event.identity.part = 3;
    event.identity.hops = {{"face", 10, 20}};
    event.header = {{"faces", {1, 2}}};
    const Emission sent(event);
    const Event back = event_from_packet(sent.packet(PacketType::event, 9));
    CHECK(back.identity.source == "camera");
    CHECK(back.identity.sequence == 42);
    CHECK(back.identity.lossless);
    CHECK(back.identity.captured_us == event.identity.captured_us);
    CHECK(back.identity.part == 3);
    REQUIRE(back.identity.hops.size() == 1);
    CHECK(back.identity.hops[0].work_us == 20);
    CHECK(back.header == event.header);
    CHECK(back.size == 10);
    CHECK(back.body.data() == event.body.data());  // shared, not copied
}

TEST_CASE("emission: the header is encoded once for all receivers")
{
    const auto sent = emission(1);
    CHECK(sent->packet(PacketType::event, 1).header == sent->packet(PacketType::event, 2).header);
}

TEST_CASE("emission: a notification has the size of the body and no body")
{
    const auto packet = emission(1)->packet(PacketType::notification, 1);
    CHECK(packet.body.empty());
    CHECK(event_from_packet(packet).size == 10);
}

TEST_CASE("emission: group, turn and attempt of shared work travel in the header, and on to the results")
{
    const Event shared = event_from_packet(emission(1)->packet(PacketType::event, 1, {"workers", 17, 3}));
    CHECK(shared.identity.group == "workers");
    CHECK(shared.identity.turn == 17);
    CHECK(shared.identity.attempt == 3);
    const Event result = event_from_packet(Emission(shared).packet(PacketType::event, 1));
    CHECK(result.identity.turn == 17);
    CHECK(event_from_packet(emission(1)->packet(PacketType::event, 1)).identity.attempt == 0);
}

TEST_CASE("emission: a header over the limit is refused where it is made")
{
    Event event = emission(1)->event();
    event.header = {{"text", std::string(15'000, 'x')}, {"more", std::string(15'000, 'y')}, {"and", std::string(15'000, 'z')}, {"so", std::string(15'000, 'a')},
                    {"on", std::string(15'000, 'b')}};
    CHECK_THROWS_AS(Emission{event}, Error);
}

TEST_CASE("emission: a packet with a wrong header is malformed")
{
    for (const char* header : {"{}", "[]", "{\"source\":\"a b\"}", "{\"source\":\"camera\",\"epoch\":-1}"})
        CHECK_THROWS_AS(event_from_packet(protocol::make_packet(PacketType::event, header)), Error);
}

}  // namespace hive::event
