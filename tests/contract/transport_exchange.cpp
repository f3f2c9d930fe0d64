// What a good connection does: packets both ways, whole and in order, and an end that is told once.
#include "transport_world.hpp"

#include <cstring>
#include <thread>

using namespace world;

TEST_CASE_TEMPLATE("connection: hellos are exchanged and packets keep their order both ways", Place, Unix, Tcp, Tls)
{
    Pair pair(Place::address, patient);
    for (int i = 0; i < 50; ++i) {
        pair.dialing.send(PacketType::get, std::to_string(i));
        pair.listening.send(PacketType::confirmation, std::to_string(1000 + i));
    }
    REQUIRE(pair.loop.until([&] { return pair.dialing.has(50) && pair.listening.has(50); }));
    for (int i = 0; i < 50; ++i) {
        CHECK(pair.listening.packets[i].header_text() == std::to_string(i));
        CHECK(pair.listening.packets[i].type == PacketType::get);
        CHECK(pair.dialing.packets[i].header_text() == std::to_string(1000 + i));
    }
    CHECK_FALSE(pair.dialing.connection->peer().empty());
}

TEST_CASE_TEMPLATE("connection: a peer on this machine is known to be here, whatever the transport, and only one at a "
                   "unix socket can share memory",
                   Place, Unix, Tcp, Tls)
{
    Pair pair(Place::address, patient);
    const bool shares = Place::address(pair.folder).scheme == hive::transport::Address::Scheme::unix_socket;
    for (const auto& connection : {pair.dialing.connection, pair.listening.connection}) {
        CHECK(connection->local());
        CHECK(connection->can_share() == shares);
    }
}

TEST_CASE_TEMPLATE("connection: a thousand small packets with bodies come whole and in order", Place, Unix, Tcp, Tls)
{
    Pair pair(Place::address, patient);
    for (int i = 0; i < 1000; ++i)
        pair.dialing.send(PacketType::event, std::to_string(i),
                          std::string(static_cast<std::size_t>(i % 97), static_cast<char>(i)));
    REQUIRE(pair.loop.until([&] { return pair.listening.has(1000); }));
    bool same = true;
    for (int i = 0; i < 1000; ++i) {
        const auto& packet = pair.listening.packets[i];
        const std::string body(static_cast<std::size_t>(i % 97), static_cast<char>(i));
        same = same && packet.header_text() == std::to_string(i) && packet.body.size() == body.size()
               && std::equal(body.begin(), body.end(), reinterpret_cast<const char*>(packet.body.data()));
    }
    CHECK(same);
}

TEST_CASE_TEMPLATE("connection: bodies of awkward sizes up to the limit of 64 MiB are identical", Place, Unix, Tcp, Tls)
{
    Pair pair(Place::address, patient);
    std::vector<hive::Body> bodies;
    for (const std::size_t size : {std::size_t{1}, std::size_t{16 * 1024 - 16}, std::size_t{16 * 1024},
                                   std::size_t{100'001}, std::size_t{64} << 20}) {
        std::vector<unsigned char> bytes(size);
        for (std::size_t i = 0; i < size; ++i)
            bytes[i] = static_cast<unsigned char>(i * 2654435761U >> 13);
        bodies.emplace_back(std::move(bytes));
        pair.dialing.send(PacketType::event, "h", bodies.back());
    }
    REQUIRE(pair.loop.until([&] { return pair.listening.has(bodies.size()); }, 30s));
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto& body = pair.listening.packets[i].body;
        REQUIRE(body.size() == bodies[i].size());
        CHECK(std::memcmp(body.data(), bodies[i].data(), body.size()) == 0);
    }
}

TEST_CASE_TEMPLATE("connection: closed is told once to either end, and written callbacks once each", Place, Unix, Tcp,
                   Tls)
{
    Pair pair(Place::address, patient);
    int yes = 0;
    int no = 0;
    const auto count = [&](bool written) { ++(written ? yes : no); };
    pair.dialing.send(PacketType::get, "first", {}, count);
    CHECK(yes == 0);  // never from inside
    REQUIRE(pair.loop.until([&] { return yes == 1; }));
    for (int i = 0; i < 5; ++i)
        pair.dialing.send(PacketType::event, "late", std::string(1 << 20, 'x'), count);
    pair.dialing.connection->close({Errc::stopped, "enough"});
    pair.dialing.connection->close({Errc::io, "again"});
    pair.dialing.send(PacketType::get, "after the end", {}, count);
    CHECK(pair.dialing.closed == 0);  // never from inside
    CHECK(no == 0);
    REQUIRE(pair.loop.until([&] { return pair.dialing.closed == 1 && pair.listening.closed == 1 && no == 6; }));
    pair.loop.run_for(30ms);
    CHECK(pair.dialing.closed == 1);
    CHECK(pair.dialing.code == Errc::stopped);
    CHECK(pair.dialing.text == "enough");
    CHECK(pair.listening.closed == 1);
    CHECK(pair.listening.code == Errc::connection_lost);
    CHECK(yes == 1);
    CHECK(no == 6);
}

TEST_CASE_TEMPLATE("connection: the last reference ends it, and whoever waited for a packet to be written is told",
                   Place, Unix, Tcp, Tls)
{
    Pair pair(Place::address, patient);
    int told = 0;
    pair.dialing.send(PacketType::event, "big", std::string(8 << 20, 'x'), [&](bool written) {
        CHECK_FALSE(written);
        ++told;
    });
    pair.dialing.connection.reset();
    REQUIRE(pair.loop.until([&] { return pair.listening.closed == 1 && told == 1; }));
    CHECK(pair.listening.code == Errc::connection_lost);
    CHECK(pair.dialing.closed == 0);  // nobody is left to be told
}

TEST_CASE_TEMPLATE("connection: a handler may let go of the connection while it runs", Place, Unix, Tcp, Tls)
{
    Pair pair(Place::address, patient);
    pair.listening.on_packet = [&](const Packet&) { pair.listening.connection.reset(); };
    pair.dialing.send(PacketType::get, "1");
    pair.dialing.send(PacketType::get, "2");
    REQUIRE(pair.loop.until([&] { return pair.dialing.closed == 1; }));
    CHECK(pair.listening.packets.size() == 1);
}

TEST_CASE_TEMPLATE("connection: handlers that own their connection go with it, or with the event loop", Place, Unix,
                   Tcp, Tls)
{
    std::weak_ptr<int> alive;
    {
        Pair pair(Place::address, patient);
        auto token = std::make_shared<int>(1);
        alive = token;
        hive::transport::dial(
            pair.loop.context, pair.listener->address(), 5s,
            [token](auto dialed) {
                const auto connection = value_or_none(std::move(dialed));
                connection->start({.packet = [connection, token](Packet&&) {}, .closed = {}});
            },
            patient, security_of(Place::address, pair.folder));
        token.reset();
        auto& first = pair.listening.connection;
        REQUIRE(pair.loop.until([&, was = first] { return first != was; }));
    }
    CHECK(alive.expired());
}

TEST_CASE_TEMPLATE("connection: what follows the hello waits until open", Place, Unix, Tcp, Tls)
{
    Pair pair(Place::address, patient, false);
    pair.dialing.send(PacketType::event, "early", std::string(300'000, 'x'));
    pair.loop.run_for(50ms);
    CHECK(pair.listening.packets.empty());
    pair.listening.connection->open({});
    CHECK(pair.listening.packets.empty());  // never from inside
    REQUIRE(pair.loop.until([&] { return pair.listening.has(1); }));
    CHECK(pair.listening.packets[0].body.size() == 300'000);
}

TEST_CASE_TEMPLATE("connection: heartbeats keep an idle connection and are shown to nobody", Place, Unix, Tcp, Tls)
{
    Pair pair(Place::address, {.heartbeat = 20ms, .silence = 400ms, .first_packet = 5s, .stall = 5s});
    pair.loop.run_for(900ms);
    CHECK(pair.dialing.closed + pair.listening.closed == 0);
    CHECK(pair.dialing.packets.empty());
    CHECK(pair.listening.packets.empty());
}

TEST_CASE_TEMPLATE("connection: the two ends may live on two threads", Place, Unix, Tcp, Tls)
{
    Folder folder;
    Loop here;
    Loop there;
    End dialing;
    End listening;
    auto listener = hive::transport::listen(
        there.context, Place::address(folder), [&](auto connection) { listening.start(std::move(connection)); },
        patient, security_of(Place::address, folder));
    listening.on_packet = [&](const Packet& packet) {
        listening.send(packet.type, std::string(packet.header_text()), packet.body);
    };
    std::thread other([&] { there.until([&] { return listening.closed == 1; }, 20s); });
    const auto begin = [&](auto connection) {
        dialing.start(value_or_none(std::move(connection)));
        dialing.send(PacketType::hello, "{}");
        for (int i = 0; i < 200; ++i)
            dialing.send(PacketType::event, std::to_string(i), std::string(2000, 'x'));
    };
    hive::transport::dial(here.context, listener->address(), 5s, begin, patient, security_of(Place::address, folder));
    CHECK(here.until([&] { return dialing.has(201); }));
    if (dialing.connection)
        dialing.connection->close({Errc::stopped, "done"});
    here.until([&] { return dialing.closed == 1; });
    other.join();
    CHECK(listening.closed == 1);
}
