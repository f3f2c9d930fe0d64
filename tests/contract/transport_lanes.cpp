// The two lanes: control overtakes events, events wait without being dropped, and control may not pile up.
#include "transport_world.hpp"

using namespace world;

TEST_CASE_TEMPLATE("lanes: a control packet overtakes the events that wait", Place, Unix, Tcp, Tls)
{
    Pair pair(Place::address, patient, false);  // the listening end does not read yet
    int written = 0;
    for (int i = 0; i < 6; ++i)
        pair.dialing.send(PacketType::event, std::to_string(i), std::string(2 << 20, 'x'),
                          [&](bool out) { written += out; });
    pair.loop.run_for(50ms);
    pair.dialing.send(PacketType::get, "urgent");
    CHECK(written == 0);
    pair.listening.connection->open({});
    REQUIRE(pair.loop.until([&] { return pair.listening.has(7); }, 20s));
    CHECK(pair.listening.packets[0].header_text() == "0");  // had begun
    CHECK(pair.listening.packets[1].header_text() == "urgent");
    for (int i = 1; i < 6; ++i)
        CHECK(pair.listening.packets[i + 1].header_text() == std::to_string(i));
    CHECK(pair.loop.until([&] { return written == 6; }));
}

TEST_CASE_TEMPLATE("lanes: a peer that never reads keeps events waiting and is cut off when control packets pile up",
                   Place, Unix, Tcp)
{
    RawPair pair(Place::address, patient);
    pair.write(hello());
    REQUIRE(pair.loop.until([&] { return pair.end.has(1); }));
    int unwritten = 0;
    for (int i = 0; i < 4; ++i)
        pair.end.send(PacketType::event, "e", std::string(2 << 20, 'x'), [&](bool written) { unwritten += !written; });
    pair.loop.run_for(50ms);
    CHECK(unwritten == 0);
    CHECK(pair.end.closed == 0);
    std::size_t sent = 0;
    for (; sent <= 2 * patient.control_bytes && pair.end.closed == 0; sent += 1016) {
        pair.end.send(PacketType::get, std::string(1000, 'c'));
        pair.loop.context.poll();
    }
    REQUIRE(pair.until_closed());
    CHECK(pair.end.code == Errc::too_large);
    CHECK(sent > patient.control_bytes - 4096);
    CHECK(sent < patient.control_bytes + 4096);
    CHECK(unwritten == 4);
}
