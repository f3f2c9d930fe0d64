// A replay in a swarm: a restarted recording is a restarted source.
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <set>
#include <utility>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

std::int64_t refused_by_track(hive::Application& application)
{
    std::int64_t refused = 0;
    for (const auto& input : application.status("track").inputs)
        refused += input.abandoned;
    return refused;
}

/// A file of the faces in five images.
std::string recorded_faces(const Swarm& swarm)
{
    const auto file = (swarm.home() / "faces.hive").string();
    const auto camera = swarm.drone("camera", "camera", {"noise=0"}), face = swarm.drone("face", "face");
    swarm.application().connect({"camera", ""}, {"face", ""});
    swarm.hivectl_done({"record", "face.faces", "-o", file, "-n", "5"});
    return file;
}

/// The epochs and sequences of this many results, each of which must be unique.
std::set<std::pair<std::int64_t, std::int64_t>> identities(hive::Collector& tracks, std::size_t count)
{
    std::set<std::pair<std::int64_t, std::int64_t>> all;
    for (std::size_t i = 0; i < count; ++i) {
        const auto event = tracks.next(patient(5000ms));
        REQUIRE_MESSAGE(event, "after ", i);
        CHECK(event->identity.source == "camera");
        CHECK(all.emplace(event->identity.epoch, event->identity.sequence).second);
    }
    return all;
}

}  // namespace

TEST_CASE("replay: a drone that keeps state accepts each round of a loop")
{
    const Swarm swarm;
    const auto file = recorded_faces(swarm);
    const auto track = swarm.drone("track", "track");
    const auto replay = swarm.drone("replay", "replay", {"file=" + file, "pace=demand", "loop=on"});
    auto application = swarm.application();
    const auto tracks = application.collect({{"track", "tracks"}});
    application.connect({"replay", ""}, {"track", ""});
    const auto seen = identities(*tracks, 15);
    CHECK(seen.rbegin()->first - seen.begin()->first == 2);
    CHECK(refused_by_track(application) == 0);
}

TEST_CASE("replay: a drone that keeps state accepts a recording that is set again")
{
    const Swarm swarm;
    const auto file = recorded_faces(swarm);
    const auto track = swarm.drone("track", "track");
    const auto replay = swarm.drone("replay", "replay", {"file=" + file, "pace=demand"});
    auto application = swarm.application();
    const auto tracks = application.collect({{"track", "tracks"}});
    application.connect({"replay", ""}, {"track", ""});
    const auto first = identities(*tracks, 5);
    REQUIRE(eventually([&] { return tracks->ended().has_value(); }));
    application.set("replay", {{"file", file}});
    REQUIRE(eventually([&] { return !tracks->ended(); }));
    const auto second = identities(*tracks, 5);
    CHECK(second.begin()->first == first.begin()->first + 1);
    CHECK(refused_by_track(application) == 0);
}
