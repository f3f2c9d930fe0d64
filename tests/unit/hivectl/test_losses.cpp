// Tests of what senders say that hivectl did not get.
#include "words/losses.hpp"

#include <doctest/doctest.h>

using namespace hivectl;
using hive::Fate;

namespace {

constexpr auto own_name = "app-7";
constexpr std::int64_t own_registration = 12;

std::vector<hive::InputStatus> received(std::int64_t events)
{
    return {{.input = "camera.image", .from = "camera.image", .registration = own_registration, .received = events}};
}

/// To another application of that name, and to this one.
std::vector<hive::StatusAnswer> camera(const hive::Ledger& own)
{
    hive::OutputStatus output{.name = "image", .type = "image/jpeg"};
    for (const std::int64_t number : {own_registration - 1, own_registration})
        output.edges.push_back({.receiver = own_name, .registration = number});
    output.edges[0].events.came(50);
    output.edges[0].events.went(Fate::lost_cut_off, 50);
    output.edges[1].events = own;
    hive::Status status{.name = "camera", .kind = "camera"};
    status.outputs.push_back(output);
    return {{"camera", status}};
}

}  // namespace

TEST_CASE("losses: when all that was produced came, there are none, whatever others of that name lost")
{
    hive::Ledger events;
    events.came(40);
    events.went(Fate::acknowledged, 38);
    CHECK(losses_of(own_name, received(40), camera(events)).empty());
}

TEST_CASE("losses: each fate that is a loss is told with its reason, but for what arrived all the same")
{
    hive::Ledger events;
    events.came(40);
    events.went(Fate::lost_connection, 3);
    events.went(Fate::acknowledged, 30);
    events.went(Fate::skipped, 4);
    const auto told = losses_of(own_name, received(34), camera(events));
    REQUIRE(told.size() == 2);
    CHECK(sentence(told[0]) == "camera.image: 4 events, skipped by the sender: hivectl had not requested them in time");
    CHECK_FALSE(told[0].promised);
    CHECK(sentence(told[1]) == "camera.image: 2 events, lost when the connection broke");
    CHECK(told[1].promised);
}

TEST_CASE("losses: a sender that was started again, or is silent, says nothing of them")
{
    auto again = camera({});
    std::get<hive::Status>(again[0].status).outputs[0].edges.pop_back();
    CHECK(losses_of(own_name, received(40), again).empty());
    CHECK(losses_of(own_name, received(40), {{"camera", hive::Error(hive::Errc::timeout, "silent")}}).empty());
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
