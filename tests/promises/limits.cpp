// Many peers, many receivers, many connections: nothing is left out, nobody is shut out, nothing piles up.
#include "taking.hpp"

#include <raw_peer.hpp>

#include <iterator>

using namespace hive::test;
using hive::Json;

namespace {

void answer_pings(std::vector<raw::Peer>& peers)
{
    for (auto& peer : peers)
        peer.next(0ms);
}

Json registration(std::int64_t epoch, const std::string& receiver, const Json& options)
{
    return {{"epoch", epoch}, {"output", "tick"}, {"receiver", receiver}, {"options", options}};
}

}  // namespace

TEST_CASE("limits: connections lists 140 receivers of one output, each with its counts")
{
    constexpr int per_peer = 35;
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=5"});
    std::vector<raw::Peer> peers;
    for (int i = 1; i <= 4; ++i) {
        const auto name = "peer-" + std::to_string(i);
        peers.push_back(raw::Peer::meet(swarm.home() / "source.sock", name));
        for (int channel = 1; channel <= per_peer; ++channel) {
            const auto receiver = name + ".input-" + std::to_string(channel);
            const auto answer =
                peers.back().ask(raw::register_, registration(channel, receiver, {{"delivery", "notify"}}), channel);
            REQUIRE_MESSAGE(raw::error_of(answer) == "", raw::text_of(answer));
        }
        answer_pings(peers);
    }
    auto asking = swarm.hivectl_running({"connections", "--json", "--timeout", "10"}, "connections");
    REQUIRE(eventually(  // who answers no pings is cut off
        [&] {
            answer_pings(peers);
            return asking.wait(1ms).has_value();
        },
        10'000ms));
    const auto rows = Json::parse(swarm.log("connections"));
    CHECK(rows.size() == 4 * per_peer);
    CHECK(std::ranges::all_of(rows, [](const Json& row) { return came_to(row).has_value(); }));
}

TEST_CASE("limits: whoever controls a drone gets in, however many strangers are there already")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=1"});
    std::vector<raw::Peer> strangers;
    for (int i = 0; i < 256; ++i) {
        auto stranger = raw::Peer::dial(swarm.home() / "source.sock");
        stranger.send(raw::hello_packet("stranger-" + std::to_string(i)));
        if (!stranger.next(10'000ms)) {
            REQUIRE(stranger.ended());
            break;  // no place for more
        }
        strangers.push_back(std::move(stranger));
        if (i % 64 == 0)
            answer_pings(strangers);
    }
    REQUIRE(strangers.size() > 128);
    for (const auto& words : {std::vector<std::string>{"ps", "source"}, {"get", "source", "fps"}, {"stop", "source"}}) {
        CAPTURE(words[0]);
        answer_pings(strangers);
        const auto done = swarm.hivectl(words);
        CHECK_MESSAGE(done.exit_code == 0, done.err);
    }
}

TEST_CASE("limits: connecting again and again, and groups that come and go, leave nothing behind")
{
    constexpr int times = sanitized() ? 60 : 400;
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=20"}), worker = swarm.drone("sleeper", "worker");
    auto peer = raw::Peer::meet(swarm.home() / "worker.sock");
    const Json from{{"drone", "source"}, {"output", "tick"}};
    const auto connect_and_leave = [&](int i) {
        REQUIRE(
            raw::error_of(peer.ask(raw::connect, {{"from", from}, {"input", "image"}, {"options", {{"window", 4}}}}))
            == "");
        if (i % 2 == 1)
            REQUIRE(raw::error_of(peer.ask(raw::disconnect, {{"from", {{"drone", "source"}}}})) == "");
        const auto name = "member-" + std::to_string(i);
        auto member = raw::Peer::meet(swarm.home() / "source.sock", name);
        const Json options{{"group", "group-" + std::to_string(i % 40)}};
        REQUIRE(raw::error_of(member.ask(raw::register_, registration(i + 1, name, options), 1)) == "");
    };
    for (int i = 0; i < times / 2; ++i)
        connect_and_leave(i);
    const auto bytes = resident_bytes(source.pid()) + resident_bytes(worker.pid());
    const auto descriptors = open_descriptors(source.pid()) + open_descriptors(worker.pid());
    for (int i = times / 2; i < 2 * times; ++i)
        connect_and_leave(i);
    auto application = swarm.application();
    CHECK(eventually([&] { return receivers(application, "source").size() <= 1; }));
    CHECK(
        eventually([&] { return open_descriptors(source.pid()) + open_descriptors(worker.pid()) <= descriptors + 4; }));
    if (!sanitized())
        CHECK(resident_bytes(source.pid()) + resident_bytes(worker.pid()) < bytes + (4u << 20));
    CHECK(status_of(application, "source").dump().size() < 32'000);
}
