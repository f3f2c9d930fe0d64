// Tests what each kind of peer can do to a drone that listens on tcp: on a running drone, packet by packet, and printed
// as a table.
#include "swarm.hpp"

#include <hive/protocol/messages.hpp>
#include <hive/protocol/permission.hpp>
#include <hive/transport/transport.hpp>

#include <asio/io_context.hpp>
#include <doctest/doctest.h>

#include <algorithm>
#include <iostream>
#include <list>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;
using hive::Role;
using hive::protocol::Direction;
using hive::protocol::PacketType;

namespace {

namespace fs = std::filesystem;

/// The outcome of a packet.
enum class Fate { taken, closed, kept_out };

std::string word(Fate fate) { return fate == Fate::taken ? "taken" : fate == Fate::closed ? "closed" : "kept out"; }

/// A valid header for this type; its subject need not exist.
std::string header_for(PacketType type)
{
    switch (type) {
    case PacketType::ping:
    case PacketType::pong:
    case PacketType::release: return {};
    case PacketType::request: return R"({"epoch":1,"id":1})";
    case PacketType::register_receiver: return R"({"id":1,"epoch":1,"output":"nothing","receiver":"stranger"})";
    default: return R"({"id":1})";
    }
}

/// Dials the drone, sends hello and one packet, and checks whether a query is still answered afterwards.
class Try {
public:
    Try(const std::string& address, const fs::path& key)
    {
        using namespace hive::transport;
        const Security security{.keys = key.empty() ? nullptr : std::make_shared<KeyRing>(key)};
        bool answered = false;
        dial(
            context_, parse_address(address), patient(5000ms),
            [&](auto connection) {
                answered = true;
                connection_ = value_or_none(std::move(connection));
            },
            Timing{.silence = patient(5000ms), .first_packet = patient(5000ms)}, security);
        until([&] { return answered; });
        if (!connection_)
            return;
        connection_->start({.packet = [this](hive::protocol::Packet&& packet) { on_packet(packet); },
                            .closed = [this](const hive::Error&) { closed_ = true; }});
        static std::int64_t started = 0;  // each is another one
        send(PacketType::hello, hive::to_text(to_json(hive::protocol::Hello{
                                    .name = "stranger", .kind = "application", .epoch = ++started, .pid = 1})));
        until([&] { return met_ || closed_; });
    }

    Fate of(PacketType type)
    {
        if (!met_)
            return Fate::kept_out;
        if (type != PacketType::hello)
            send(type, header_for(type));
        until([&] { return unwritten_ == 0 || closed_; });  // otherwise the query would overtake an event
        send(PacketType::describe, R"({"id":2})");
        until([&] { return described_ || closed_; });
        return described_ ? Fate::taken : Fate::closed;
    }

    /// From now on it has something to do here.
    void receive()
    {
        if (!met_)
            return;
        connection_->send(hive::protocol::make_packet(
            PacketType::register_receiver,
            R"({"id":3,"epoch":1,"output":"exceptions","receiver":"stranger","options":{"transfer":"stream"}})", 1));
        until([&] { return received_ || closed_; });
    }
    /// As of now.
    bool is_in()
    {
        context_.restart();
        context_.poll();
        return met_ && !closed_;
    }

private:
    void on_packet(const hive::protocol::Packet& packet)
    {
        if (packet.type == PacketType::hello) {
            met_ = true;
            connection_->open({});
        } else if (packet.type == PacketType::confirmation) {
            described_ = described_ || hive::parse_json(packet.header_text()).at("id") == 2;
            received_ = received_ || hive::parse_json(packet.header_text()).at("id") == 3;
        }
    }
    void send(PacketType type, std::string header)
    {
        ++unwritten_;
        connection_->send(hive::protocol::make_packet(type, std::move(header)), [this](bool) { --unwritten_; });
    }
    template <class Condition>
    void until(const Condition& condition)
    {
        const auto end = Clock::now() + patient(10'000ms);
        while (!condition() && Clock::now() < end) {
            if (context_.stopped())
                context_.restart();
            context_.run_one_for(5ms);
        }
        REQUIRE(condition());
    }

    asio::io_context context_;
    std::shared_ptr<hive::transport::Connection> connection_;
    int unwritten_ = 0;
    bool met_ = false, closed_ = false, described_ = false, received_ = false;
};

/// The drone under test; it is restarted when a peer was permitted to stop it.
class Target {
public:
    explicit Target(const Swarm& swarm) : swarm_(swarm) { start(); }
    [[nodiscard]] const std::string& address() const { return address_; }
    [[nodiscard]] std::string local_address() const { return "unix:" + (swarm_.home() / "sleeper.sock").string(); }
    /// @return  whether the drone was stopped
    bool restarted_if_stopped()
    {
        if (!process_->wait(patient(3000ms)))
            return false;
        start();
        return true;
    }

private:
    void start()
    {
        process_.emplace(swarm_.drone("sleeper", "sleeper", {}, {"--listen", "tcp://127.0.0.1:0"}));
        const std::string text = swarm_.log("sleeper"), before = "listening on ";
        const auto begin = text.rfind(before + "tcp://") + before.size();
        address_ = text.substr(begin, text.find('\n', begin) - begin);
    }

    const Swarm& swarm_;
    std::optional<Process> process_;
    std::string address_;
};

std::string padded(std::string text)
{
    text.resize(std::max<std::size_t>(14, text.size() + 1), ' ');
    return text;
}

}  // namespace

TEST_CASE(
    "permissions: what strangers, viewers, members and the owner can do to a running drone is what the table says")
{
    const Swarm swarm;
    swarm.hivectl_done({"key", "new"});
    swarm.hivectl_done({"key", "view"});
    const auto wrong = swarm.home() / "wrong.key", viewer = swarm.key_file().parent_path() / "viewer.key";
    swarm.hivectl_done({"key", "new", "--file", wrong.string()});
    struct Column {
        std::string title;
        fs::path key;
        std::optional<Role> role;
    };
    const std::vector<Column> columns{{"no key", "", std::nullopt},
                                      {"another key", wrong, std::nullopt},
                                      {"viewers' key", viewer, Role::viewer},
                                      {"members' key", swarm.key_file(), Role::member},
                                      {"local socket", "", Role::owner}};
    Target target(swarm);
    std::string table = padded("packet");
    for (const auto& column : columns)
        table += padded(column.title);
    table += "\n";
    for (int number = 0; number <= 255; ++number) {
        const auto type = static_cast<PacketType>(number);
        if (hive::protocol::token(type).empty())
            continue;
        table += padded(std::string(hive::protocol::token(type)));
        for (const auto& [title, key, role] : columns) {
            const bool owner = role == Role::owner;
            auto fate = Try(owner ? target.local_address() : target.address(), key).of(type);
            const bool may_stop = owner || role == Role::member;
            if (type == PacketType::stop && may_stop && target.restarted_if_stopped())
                fate = Fate::taken;
            table += padded(word(fate));
            const auto expected = !role                                                          ? Fate::kept_out
                                  : hive::protocol::permits(*role, Direction::to_listener, type) ? Fate::taken
                                                                                                 : Fate::closed;
            CHECK_MESSAGE(fate == expected, title, ": ", hive::protocol::token(type), " was ", word(fate));
        }
        table += "\n";
    }
    std::cout << table;
}

TEST_CASE("permissions: viewers have 64 places of a drone, and when members need these too, one viewer goes for each")
{
    const Swarm swarm;
    swarm.hivectl_done({"key", "new"});
    swarm.hivectl_done({"key", "view"});
    const auto member = swarm.key_file(), viewer = member.parent_path() / "viewer.key";
    const Target target(swarm);
    std::list<Try> viewers, members;
    const auto still_in = [](std::list<Try>& peers) { return std::ranges::count_if(peers, &Try::is_in); };
    const auto come = [&](std::list<Try>& peers, const fs::path& key, int count) {
        for (int i = 0; i < count; ++i) {
            peers.emplace_back(target.address(), key).receive();
            still_in(viewers);
            still_in(members);
        }
    };
    come(viewers, viewer, 67);
    CHECK(still_in(viewers) == 64);
    CHECK_FALSE(viewers.back().is_in());
    come(members, member, 256 + 32 - 64);  // 32 places are for applications
    CHECK(still_in(viewers) == 64);
    come(members, member, 3);
    const auto end = Clock::now() + patient(2000ms);
    while (still_in(viewers) > 61 && Clock::now() < end)
        still_in(members);
    CHECK(still_in(viewers) == 61);
    CHECK(still_in(members) == 256 + 32 - 61);
    CHECK(swarm.log("sleeper").find("64 viewers are connected") != std::string::npos);
}
