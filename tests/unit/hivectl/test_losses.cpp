// Tests of what senders say that hivectl did not get.
#include "losses.hpp"

#include <doctest/doctest.h>

using namespace hivectl;
using hive::Fate;

namespace {

constexpr auto own_name = "app-7";
const std::vector<hive::Endpoint> image{{"camera", "image"}};

/// @param came  of those produced, to hivectl
std::vector<hive::StatusAnswer> camera(std::int64_t produced, std::int64_t came, std::int64_t epoch = 1)
{
    hive::OutputStatus output{.name = "image", .type = "image/jpeg", .produced = produced};
    for (const char* receiver : {"face.image", own_name})
        output.edges.push_back({.receiver = receiver, .connected = true});
    output.edges[0].events.came(produced);
    output.edges[0].events.went(Fate::dropped, produced);
    output.edges[1].events.came(came);
    hive::Status status{.name = "camera", .kind = "camera", .epoch = epoch};
    status.outputs.push_back(output);
    return {{"camera", status, {}}};
}

hive::Ledger& own_events(std::vector<hive::StatusAnswer>& answers)
{
    return answers[0].status.outputs[0].edges[1].events;
}

}  // namespace

TEST_CASE("losses: when all that was produced came, there are none, whatever others lost")
{
    const Losses losses(own_name, image, camera(10, 2));
    CHECK(losses.until(camera(50, 42)).empty());
}

TEST_CASE("losses: each fate that is a loss is told with its reason, counted from the first look")
{
    auto first = camera(10, 10), last = camera(40, 40);
    own_events(first).went(Fate::lost_connection, 1);
    own_events(last).went(Fate::lost_connection, 3);
    own_events(last).went(Fate::acknowledged, 30);
    own_events(last).went(Fate::skipped, 4);
    const auto told = Losses(own_name, image, first).until(last);
    REQUIRE(told.size() == 2);
    CHECK(sentence(told[0]) == "camera.image: 4 events, skipped by the sender: hivectl had not asked for them in time");
    CHECK_FALSE(told[0].promised);
    CHECK(sentence(told[1]) == "camera.image: 2 events, lost when the connection broke");
    CHECK(told[1].promised);
}

TEST_CASE("losses: what was emitted while hivectl was not connected did not come to its edge, and is counted")
{
    const auto told = Losses(own_name, image, camera(10, 10)).until(camera(50, 20));
    REQUIRE(told.size() == 1);
    CHECK(sentence(told[0]) == "camera.image: 30 events, not sent: hivectl was not connected");
}

TEST_CASE("losses: of a sender that was restarted or is silent nobody knows how many")
{
    const Losses losses(own_name, image, camera(10, 10));
    CHECK(sentence(losses.until(camera(3, 3, 2)).at(0)) == "camera.image: not known: camera was restarted");
    const std::vector<hive::StatusAnswer> silent{{"camera", {}, hive::Error(hive::Errc::timeout, "silent")}};
    CHECK(sentence(losses.until(silent).at(0)) == "camera.image: not known: camera does not answer");
}

TEST_CASE("losses: a promise is broken by what is missing in order, and by all that a lossless source lost")
{
    const hive::CollectCounts none{}, missing{.missing = 1, .missing_turns = {}};
    const std::vector<Loss> skipped{{"camera.image", "skipped", 3, false}}, lost{{"camera.image", "lost", 3}};
    CHECK_FALSE(promise_broken(missing, lost, false, false));
    CHECK_FALSE(promise_broken(none, skipped, true, false));
    CHECK_FALSE(promise_broken(none, {}, true, true));
    CHECK(promise_broken(missing, {}, true, false));
    CHECK(promise_broken(none, lost, true, false));
    CHECK(promise_broken(none, lost, false, true));
    CHECK(promise_broken(none, skipped, false, true));
}
