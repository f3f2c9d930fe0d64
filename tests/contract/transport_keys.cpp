// Who comes in over tcp: those who prove the swarm's key. What the others are told, and what they cost.
#include "transport_world.hpp"

#include <switched_off.hpp>

#include <algorithm>
#include <sys/socket.h>
#include <unistd.h>

using namespace world;
using hive::KeyFileMode;
using hive::Role;
using hive::test::SwitchedOff;
using hive::transport::KeyRing;
using hive::transport::Security;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string id_in(const Folder& folder, const std::string& name)
{
    return hive::read_key_file(folder.path(name)).at(0).id;
}

/// A listener with a key (or without), and what it says of those it turns away.
struct Gate {
    Loop loop;
    Folder folder;
    std::vector<std::string> refused;
    std::vector<std::unique_ptr<End>> ends;
    std::unique_ptr<hive::transport::Listener> listener;

    explicit Gate(const Timing& timing = patient) { listen(keyed(folder), timing); }
    Gate(Security security, const Timing& timing) { listen(std::move(security), timing); }

    void listen(Security security, const Timing& timing)
    {
        security.refused = [this](const std::string& who) { refused.push_back(who); };
        listener = hive::transport::listen(
            loop.context, Tls::address(folder),
            [this](auto connection) {
                ends.push_back(std::make_unique<End>());
                ends.back()->start(std::move(connection));
                ends.back()->send(PacketType::hello, "{}");
            },
            timing, security);
    }

    /// Dials, and gives the connection or the error.
    struct Dialed {
        std::shared_ptr<Connection> connection;
        std::optional<hive::Error> error;
    };
    Dialed dial(const Security& security)
    {
        Dialed dialed;
        bool answered = false;
        hive::transport::dial(
            loop.context, listener->address(), 60s,
            [&](auto connection) {
                answered = true;
                if (const auto* error = error_of(connection))
                    dialed.error = *error;
                dialed.connection = value_or_none(std::move(connection));
            },
            patient, security);
        REQUIRE(loop.until([&] { return answered; }));
        return dialed;
    }
};

/// What it takes one with the key to get in while 250 silent strangers of another address are there before it.
struct GettingIn {
    std::chrono::milliseconds since_it_came, since_the_first_came;
};
GettingIn getting_in_takes()
{
    const auto since = [](auto begin) {
        return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begin);
    };
    Gate gate;
    const auto first = std::chrono::steady_clock::now();
    std::vector<hive::transport::Descriptor> strangers;
    for (int i = 0; i < 250; ++i) {
        strangers.emplace_back(connect_raw(gate.listener->address(), 2));
        REQUIRE(::send(strangers.back().get(), "\x16", 1, MSG_NOSIGNAL) == 1);  // as a handshake begins
        gate.loop.context.poll();
    }
    const auto begin = std::chrono::steady_clock::now();
    REQUIRE(gate.dial(keyed(gate.folder)).connection);
    return {since(begin), since(first)};
}

}  // namespace

TEST_CASE("keys: with the same key both ends know each other as a member, with the viewers' key as a viewer")
{
    Gate gate;
    const auto members = hive::read_key_file(gate.folder.path("swarm.key")).at(0);
    hive::write_key_file(gate.folder.path("viewer.key"), {hive::viewers_key(members)}, KeyFileMode::fresh);
    for (const auto& [file, role] : {std::pair{"swarm.key", Role::member}, {"viewer.key", Role::viewer}}) {
        const auto dialed = gate.dial(keyed(gate.folder, file));
        REQUIRE(dialed.connection);
        const auto count = gate.ends.size();
        REQUIRE(gate.loop.until([&] { return gate.ends.size() > count || !gate.ends.empty(); }));
        for (const auto& credentials :
             {dialed.connection->credentials(), gate.ends.back()->connection->credentials()}) {
            CHECK(credentials.role == role);
            CHECK(credentials.key == members.id);
        }
        gate.ends.clear();
    }
    CHECK(gate.refused.empty());
}

TEST_CASE("keys: another key is refused in one sentence at both ends, and makes no connection")
{
    Gate gate;
    const auto theirs = keyed(gate.folder, "other.key");
    const auto dialed = gate.dial(theirs);
    REQUIRE(dialed.error);
    const auto here = id_in(gate.folder, "swarm.key"), there = id_in(gate.folder, "other.key");
    CHECK(dialed.error->code() == Errc::not_permitted);
    CHECK(has(dialed.error->what(), "wrong swarm key"));
    CHECK(has(dialed.error->what(), there));
    CHECK(has(dialed.error->advice(), "hivectl key show"));
    REQUIRE(gate.loop.until([&] { return !gate.refused.empty(); }));
    CHECK(gate.refused.size() == 1);
    CHECK(has(gate.refused[0], there + " is not known here, where " + here + " is"));
    CHECK(gate.ends.empty());
}

TEST_CASE("keys: who knows the name of the key and not the key is refused at both ends")
{
    Gate gate;
    auto forged = hive::viewers_key(hive::new_swarm_key(1));
    forged.id = id_in(gate.folder, "swarm.key");
    hive::write_key_file(gate.folder.path("forged.key"), {forged}, KeyFileMode::fresh);
    const auto dialed = gate.dial(keyed(gate.folder, "forged.key"));
    REQUIRE(dialed.error);
    CHECK(dialed.error->code() == Errc::not_permitted);
    REQUIRE(gate.loop.until([&] { return !gate.refused.empty(); }));
    CHECK(has(gate.refused[0], "could not prove"));
    CHECK(gate.ends.empty());
}

TEST_CASE("keys: a viewer cannot pose as the swarm to a member")
{
    Folder folder;
    static_cast<void>(keyed(folder));
    const auto members = hive::read_key_file(folder.path("swarm.key")).at(0);
    hive::write_key_file(folder.path("viewer.key"), {hive::viewers_key(members)}, KeyFileMode::fresh);
    Gate gate(keyed(folder, "viewer.key"), patient);
    CHECK(gate.dial(keyed(folder)).error.value().code() == Errc::not_permitted);
    CHECK(gate.ends.empty());
    CHECK(gate.dial(keyed(folder, "viewer.key")).connection);
}

TEST_CASE("keys: plain packets to TLS are told at both ends")
{
    Gate gate;
    auto dialed = gate.dial({});
    REQUIRE(dialed.connection);
    End plain;
    plain.start(std::move(dialed.connection));
    plain.send(PacketType::hello, "{}");
    REQUIRE(gate.loop.until([&] { return plain.closed == 1 && !gate.refused.empty(); }));
    CHECK(plain.code == Errc::not_permitted);
    CHECK(has(plain.text, "swarm key"));
    CHECK(has(gate.refused[0], "no key"));
    CHECK(gate.ends.empty());
}

TEST_CASE("keys: TLS to plain packets is told at both ends")
{
    Folder folder;
    Gate gate(Security{}, patient);
    const auto dialed = gate.dial(keyed(folder));
    REQUIRE(dialed.error);
    CHECK(dialed.error->code() == Errc::not_permitted);
    CHECK(has(dialed.error->what(), "no key"));
    CHECK(has(dialed.error->advice(), "HIVE_KEY=none"));
    REQUIRE(gate.loop.until([&] { return !gate.ends.empty() && gate.ends[0]->closed == 1; }));
    CHECK(gate.ends[0]->code == Errc::not_permitted);
    CHECK(has(gate.ends[0]->text, "uses TLS"));
}

TEST_CASE("keys: a key file that others can read is not used, and the dial says why")
{
    Gate gate;
    std::filesystem::permissions(gate.folder.path("swarm.key"), std::filesystem::perms(0644));
    const auto dialed = gate.dial({.keys = std::make_shared<KeyRing>(gate.folder.path("swarm.key"))});
    REQUIRE(dialed.error);
    CHECK(dialed.error->code() == Errc::not_permitted);
    CHECK(has(dialed.error->what(), "others can read"));
    CHECK(has(dialed.error->advice(), "chmod 600"));
}

TEST_CASE("keys: strangers are closed: the silent ones after their time, the others by their first words")
{
    Gate gate(Timing{.heartbeat = 500ms, .silence = 20s, .first_packet = 300ms, .stall = 20s});
    struct Stranger {
        std::string words, sentence;
    };
    for (const auto& [words, sentence] :
         {Stranger{"", "within 300 ms"}, Stranger{"GET / HTTP/1.1\r\n\r\n", "neither TLS nor the Hive protocol"},
          Stranger{std::string("\0", 1), "neither TLS nor the Hive protocol"}, Stranger{"\x16", "within 300 ms"},
          Stranger{"\x16\x03\x01\x40" + std::string(9000, 'x'), ""},
          Stranger{"\x16\x03\x01" + std::string(300, '\xff'), ""}}) {
        gate.refused.clear();
        const int descriptor = connect_raw(gate.listener->address());
        CHECK(::send(descriptor, words.data(), words.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(words.size()));
        CHECK(gate.loop.until([&] { return gate.refused.size() == 1; }));
        if (!gate.refused.empty())
            CHECK_MESSAGE(has(gate.refused[0], sentence), gate.refused[0]);
        ::close(descriptor);
    }
    CHECK(gate.ends.empty());
    CHECK(gate.dial(keyed(gate.folder)).connection);
}

TEST_CASE("keys: a crowd of silent strangers keeps nobody out who has the key, and costs little memory")
{
    Gate gate;                                          // whose strangers may stay for patient.first_packet
    REQUIRE(gate.dial(keyed(gate.folder)).connection);  // so that the first use of TLS is not counted
    std::vector<hive::transport::Descriptor> silent;
    const auto before = resident_bytes();
    for (int i = 0; i < 200; ++i) {
        silent.emplace_back(connect_raw(gate.listener->address()));
        gate.loop.context.poll();
    }
    const auto begin = std::chrono::steady_clock::now();
    CHECK(gate.dial(keyed(gate.folder)).connection);
    CHECK(std::chrono::steady_clock::now() - begin < patient.first_packet);  // it did not wait for their time to end
    if (!sanitized)
        CHECK(resident_bytes() - before < 3u << 20);
}

TEST_CASE("keys: an address has its turn, however many strangers wait who come from another one")
{
    auto took = getting_in_takes().since_it_came;
    for (int more = 0; more < 5 && took >= 500ms; ++more)
        took = std::min(took, getting_in_takes().since_it_came);
    MESSAGE("got in after ", took.count(), " ms");
    CHECK(took < 500ms);
}

TEST_CASE("keys: when addresses have no turns, whoever comes after many strangers waits for all of them")
{
    const SwitchedOff turns("turns-by-address");
    CHECK(getting_in_takes().since_the_first_came > 700ms);  // 64 of them have to go after 250 ms, three times
}

TEST_CASE("keys: whoever has the key is in at once while a crowd from many addresses fills the room and is silent")
{
    Gate gate;
    std::vector<hive::transport::Descriptor> silent;
    for (std::uint32_t i = 0; i < 800; ++i) {
        silent.emplace_back(connect_raw(gate.listener->address(), 2 + i % 250));
        gate.loop.context.poll();
    }
    const auto begin = std::chrono::steady_clock::now();
    CHECK(gate.dial(keyed(gate.folder)).connection);
    const auto took = (std::chrono::steady_clock::now() - begin) / 1ms;
    MESSAGE("got in after ", took, " ms");
    CHECK(took < 1000);
}

TEST_CASE("keys: a key that is named has to be there; without one that is not named an end dials in the plain")
{
    Gate plain({}, patient);
    const auto missing = plain.folder.path("typo.key");
    CHECK(plain.dial({.keys = std::make_shared<KeyRing>(missing)}).connection);
    const auto dialed = plain.dial({.keys = std::make_shared<KeyRing>(missing, true)});
    CHECK_FALSE(dialed.connection);
    REQUIRE(dialed.error);
    CHECK_MESSAGE(has(dialed.error->what(), "there is no swarm key at " + missing), dialed.error->what());
}

TEST_CASE("keys: while the swarm's key is changed, old and new machines meet; then the old key ends")
{
    Gate gate;
    const auto old = hive::read_key_file(gate.folder.path("swarm.key")).at(0);
    auto ending = old;
    ending.until_s = 4'000'000'000;
    const auto fresh = hive::new_swarm_key(2);
    hive::write_key_file(gate.folder.path("rotated.key"), {fresh, ending}, KeyFileMode::fresh);
    const auto dialed = gate.dial(keyed(gate.folder, "rotated.key"));  // the listener does not know the new key yet
    REQUIRE(dialed.connection);
    CHECK(dialed.connection->credentials().key == old.id);
    hive::write_key_file(gate.folder.path("swarm.key"), {fresh, ending}, KeyFileMode::replace);
    CHECK(gate.dial(keyed(gate.folder, "rotated.key")).connection->credentials().key == fresh.id);
    hive::write_key_file(gate.folder.path("old.key"), {old}, KeyFileMode::fresh);
    CHECK(gate.dial(keyed(gate.folder, "old.key")).connection->credentials().key == old.id);
    hive::write_key_file(gate.folder.path("swarm.key"), {fresh}, KeyFileMode::replace);
    CHECK(gate.dial(keyed(gate.folder, "old.key")).error.value().code() == Errc::not_permitted);
    CHECK(gate.dial(keyed(gate.folder, "rotated.key")).connection);
}

TEST_CASE("keys: a listener that ends lets go of those who are shaking hands")
{
    Gate gate;
    const int descriptor = connect_raw(gate.listener->address());
    CHECK(::send(descriptor, "\x16", 1, MSG_NOSIGNAL) == 1);
    gate.loop.run_for(50ms);
    gate.listener.reset();
    char byte = 0;
    ssize_t got = -1;
    CHECK(gate.loop.until([&] {
        got = ::recv(descriptor, &byte, 1, MSG_DONTWAIT);
        return got == 0 || (got < 0 && errno == ECONNRESET);
    }));
    CHECK(gate.refused.empty());
    ::close(descriptor);
}

TEST_CASE("keys: a connection with a handshake, both ends in one thread, takes little longer than one without")
{
    const auto median_us = [](Gate& gate, const Security& security) {
        std::vector<std::int64_t> times;
        for (int i = 0; i < 101; ++i) {
            const auto begin = std::chrono::steady_clock::now();
            const auto dialed = gate.dial(security);
            REQUIRE(dialed.connection);
            times.push_back((std::chrono::steady_clock::now() - begin) / 1us);
        }
        std::ranges::nth_element(times, times.begin() + 50);
        return times[50];
    };
    Gate gate, plain({}, patient);
    const auto with = median_us(gate, keyed(gate.folder)), without = median_us(plain, {});
    MESSAGE("median of 101: ", with, " us with a key, ", without, " us without");
    CHECK(with < (sanitized ? 100'000 : 5'000));  // noise of the machine; what it is in peace, the line above says
}
