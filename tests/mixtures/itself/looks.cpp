// Oracles that look at every status: each is quiet at a good one, and fires at one that breaks its promise.
#include "../fates.hpp"
#include "../limits.hpp"
#include "../pace.hpp"
#include "../waits.hpp"
#include "../window.hpp"

#include <doctest/doctest.h>

using namespace hive;
using namespace hive::mixtures;
using namespace std::chrono_literals;

namespace {

constexpr int max_in_hand = 3;

ConnectionOptions synchronized() { return {.window = max_in_hand, .group = {}}; }

/// source.tick -> a1.image, with three events in hand; a1.result -> collector, with one.
Statuses working()
{
    EdgeStatus edge{.receiver = "a1.image", .connected = true, .registration = 5, .options = synchronized()};
    edge.events.came(3);
    edge.why = Reason::not_asked;
    EdgeStatus collected{.receiver = "collector", .connected = true, .registration = 2, .options = synchronized()};
    collected.events.came(1);
    const InputStatus input{.input = "image",
                            .from = "source.tick",
                            .connected = true,
                            .registration = 5,
                            .options = synchronized(),
                            .received = 3,
                            .queued = 2,
                            .in_hand = 1};
    const OutputStatus tick{.name = "tick", .type = "a/b", .produced = 3, .edges = {edge}};
    const OutputStatus result{.name = "result", .type = "a/b", .edges = {collected}};
    return {{source, {.name = source, .kind = "ticker", .uptime_us = 900, .outputs = {tick}}},
            {"a1", {.name = "a1", .kind = "sleeper", .uptime_us = 800, .outputs = {result}, .inputs = {input}}}};
}

EdgeStatus& tick_edge(Statuses& statuses) { return statuses.at(source).outputs[0].edges[0]; }
EdgeStatus& result_edge(Statuses& statuses) { return statuses.at("a1").outputs[0].edges[0]; }
InputStatus& image_input(Statuses& statuses) { return statuses.at("a1").inputs[0]; }

const Topology one_stage{.demand = true, .stages = {{.drones = {"a1"}, .options = synchronized()}}};

bool is_of(const Problems& problems, const std::string& name)
{
    return problems.size() == 1 && problems[0].starts_with(name + ": ");
}

}  // namespace

TEST_CASE("window: a receiver with more in hand than its window is a problem, but for what it has taken over")
{
    Window oracle(true);
    auto statuses = working();
    CHECK(oracle.look(statuses).empty());  // at the first look nobody knows what was taken over
    image_input(statuses).queued = 0;
    image_input(statuses).in_hand = 0;
    CHECK(oracle.look(statuses).empty());
    image_input(statuses).queued = max_in_hand + 1;
    CHECK(is_of(oracle.look(statuses), "window"));
    image_input(statuses).registration = 6;
    CHECK(oracle.look(statuses).empty());
    image_input(statuses).queued = max_in_hand + 2;
    CHECK(is_of(oracle.look(statuses), "window"));
    image_input(statuses).queued = max_in_hand;
    CHECK(oracle.look(statuses).empty());
    image_input(statuses).queued = max_in_hand + 1;
    CHECK(is_of(oracle.look(statuses), "window"));  // it had become less
}

TEST_CASE("window: of a stream, lossless events are counted and live ones are not")
{
    auto statuses = working();
    image_input(statuses).options = {.transfer = Transfer::streaming, .group = {}};
    image_input(statuses).queued = image_input(statuses).in_hand = 0;
    auto many = statuses;
    image_input(many).queued = 65;
    Window lossless(true), live(false);
    CHECK(lossless.look(statuses).empty());
    CHECK(is_of(lossless.look(many), "window"));
    CHECK(live.look(statuses).empty());
    CHECK(live.look(many).empty());
}

TEST_CASE("window: a sender that has sent more than was asked for is a problem where it is told what was worked on")
{
    auto statuses = working();
    tick_edge(statuses).events.went(Fate::acknowledged, 3);
    Window lossless(true), live(false);
    CHECK(lossless.look(statuses).empty());
    CHECK(live.look(statuses).empty());
    tick_edge(statuses).events.came(max_in_hand + 1);
    CHECK(is_of(live.look(statuses), "window"));
    CHECK(lossless.look(statuses).empty());  // it may have results that wait
    result_edge(statuses).events.came(max_in_hand + 1);
    CHECK(is_of(lossless.look(statuses), "window"));
    result_edge(statuses).waiting = 2;  // these it has not sent
    CHECK(lossless.look(statuses).empty());
}

TEST_CASE("window: a receiver that resumes may have a window more, until it has acknowledged what it did meanwhile")
{
    auto statuses = working();
    tick_edge(statuses).events.went(Fate::acknowledged, 3);
    Window oracle(false);
    CHECK(oracle.look(statuses).empty());
    tick_edge(statuses).registration += 1;
    tick_edge(statuses).events.came(max_in_hand);
    CHECK(oracle.look(statuses).empty());
    tick_edge(statuses).events.came(1);
    CHECK(oracle.look(statuses).empty());
    tick_edge(statuses).events.went(Fate::acknowledged, max_in_hand + 1);
    CHECK(oracle.look(statuses).empty());
    tick_edge(statuses).events.came(max_in_hand + 1);
    CHECK(is_of(oracle.look(statuses), "window"));
}

TEST_CASE("pace: a source that all have asked and that does not produce is a problem after a while")
{
    Pace oracle(50ms);
    auto statuses = working();
    auto look = [&, now = Pace::Time()](std::chrono::milliseconds after) mutable {
        return oracle.look(statuses, 4, now += after);
    };
    CHECK(look(20ms).empty());
    CHECK(look(20ms).empty());
    CHECK(look(20ms).empty());
    CHECK(is_of(look(20ms), "pace"));
    CHECK(look(50ms).empty());  // a gap: who knows what was asked meanwhile
    CHECK(look(20ms).empty());
    CHECK(look(20ms).empty());
    statuses.at(source).outputs[0].why = Reason::not_asked;
    CHECK(look(20ms).empty());
    statuses.at(source).outputs[0].why = Reason::none;
    statuses.at(source).outputs[0].produced = 4;  // all that it may
    for (int i = 0; i < 10; ++i)
        CHECK(look(20ms).empty());
}

TEST_CASE("bounded: queues and rows that have grown are a problem")
{
    const Sizes oracle(one_stage);
    const auto after = [&](auto change) {
        auto statuses = working();
        change(statuses);
        return oracle.look(statuses);
    };
    CHECK(after([](Statuses&) {}).empty());
    CHECK(is_of(after([](Statuses& all) { image_input(all).queued = 257; }), "bounded"));
    CHECK(after([](Statuses& all) { image_input(all).in_hand = 258; }).empty());  // a whole queue was discarded at once
    CHECK(is_of(after([](Statuses& all) { image_input(all).in_hand = 259; }), "bounded"));
    CHECK(is_of(after([](Statuses& all) { tick_edge(all).waiting = 257; }), "bounded"));
    CHECK(is_of(after([](Statuses& all) { tick_edge(all).events.came(600); }), "bounded"));
    CHECK(is_of(after([](Statuses& all) { all["a1"].inputs.resize(3); }), "bounded"));
    CHECK(is_of(after([](Statuses& all) { all["a1"].left.resize(2); }), "bounded"));
    CHECK(is_of(after([](Statuses& all) { all["a1"].places.resize(2); }), "bounded"));
    CHECK(is_of(after([](Statuses& all) { all[source].outputs[0].edges.resize(5); }), "bounded"));
}

TEST_CASE("bounded: live events may have a longer queue, since their connection may have been a stream")
{
    auto live = one_stage;
    live.demand = false;
    auto statuses = working();
    image_input(statuses).queued = 1024;
    CHECK(Sizes(live).look(statuses).empty());
    CHECK(is_of(Sizes(one_stage).look(statuses), "bounded"));
    image_input(statuses).queued = 1025;
    CHECK(is_of(Sizes(live).look(statuses), "bounded"));
}

TEST_CASE("ages: a time that is negative or longer than the history is a problem")
{
    const auto after = [](auto change) {
        auto statuses = working();
        change(statuses.at("a1"));
        return impossible_ages(statuses, 1000us);
    };
    CHECK(after([](Status&) {}).empty());
    CHECK(is_of(after([](Status& a1) { a1.inputs[0].last_age_us = -1; }), "ages"));
    CHECK(is_of(after([](Status& a1) { a1.inputs[0].last_age_us = 1001; }), "ages"));
    CHECK(is_of(after([](Status& a1) { a1.uptime_us = 1001; }), "ages"));
    CHECK(is_of(after([](Status& a1) { a1.busy_us = 801; }), "ages"));
    CHECK(is_of(after([](Status& a1) { a1.busy_for_us = 1; }), "ages"));
}

TEST_CASE("waits: a drone that has halted and works is a problem")
{
    Waits oracle(true);
    auto statuses = working();
    auto& a1 = statuses.at("a1");
    a1.state = State::halted;
    CHECK(oracle.look(statuses).empty());
    a1.inputs[0].discarded = 2;
    a1.inputs[0].in_hand = 0;
    a1.inputs[0].processed = 1;  // that was in hand at the first look
    CHECK(oracle.look(statuses).empty());
    a1.inputs[0].processed = 2;
    CHECK(is_of(oracle.look(statuses), "waits"));
    a1.outputs[0].produced = 1;
    CHECK(is_of(oracle.look(statuses), "waits"));
    a1.state = State::idle;
    a1.inputs[0].processed = 3;
    CHECK(oracle.look(statuses).empty());
    a1.state = State::halted;  // it has finished what it was working on
    a1.inputs[0].processed = 4;
    CHECK(oracle.look(statuses).empty());
}

TEST_CASE("waits: a source on demand that produces while a place is kept is a problem")
{
    Waits lossless(true), live(false);
    auto statuses = working();
    const auto look = [&] { return std::pair(lossless.look(statuses).size(), live.look(statuses).size()); };
    tick_edge(statuses).connected = false;
    tick_edge(statuses).why = Reason::place_kept;
    CHECK(look() == std::pair<std::size_t, std::size_t>(0, 0));
    ++statuses.at(source).outputs[0].produced;
    CHECK(look() == std::pair<std::size_t, std::size_t>(1, 0));
    tick_edge(statuses).registration = 6;  // it was back in between
    ++statuses.at(source).outputs[0].produced;
    CHECK(look() == std::pair<std::size_t, std::size_t>(0, 0));
}

TEST_CASE("restored: an input that nobody wanted is a problem, and so is one that is missing")
{
    using Wanted = std::set<std::pair<std::string, std::string>>;
    CHECK(wrongly_connected(working(), Wanted{{source, "a1"}, {source, "a2"}}).empty());  // a2 does not answer
    CHECK(is_of(wrongly_connected(working(), Wanted{}), "restored"));
    CHECK(is_of(wrongly_connected(working(), Wanted{{source, "a1"}, {"a1", source}}), "restored"));
}

TEST_CASE("fates: what is lost has the cause that is counted")
{
    bool cut = false;
    const auto look_after = [&](Fate fate, std::optional<Step> step) {
        Fates oracle(
            one_stage, [&](auto&, auto&) { return cut; }, false);
        if (step)
            oracle.before(*step);
        auto statuses = working();
        tick_edge(statuses).events.went(fate);
        return oracle.look(statuses);
    };
    const Step kill{.verb = Verb::kill, .drone = "a1"}, freeze{.verb = Verb::freeze, .drone = source},
        leave{.verb = Verb::disconnect, .drone = "a1", .sender = source};
    CHECK(look_after(Fate::lost_connection, {}).empty());
    for (const auto& [fate, cause] : {std::pair(Fate::lost_killed, kill), std::pair(Fate::lost_left, leave),
                                      std::pair(Fate::lost_cut_off, freeze)}) {
        CHECK(is_of(look_after(fate, {}), "fates"));
        CHECK(look_after(fate, cause).empty());
    }
    CHECK(is_of(look_after(Fate::lost_killed, leave), "fates"));
    CHECK(is_of(look_after(Fate::lost_killed, Step{.verb = Verb::kill, .drone = source}), "fates"));
    cut = true;
    CHECK(look_after(Fate::lost_killed, {}).empty());
}

TEST_CASE("fates: an event that is given up has a cause at its receiver")
{
    Fates oracle(
        one_stage, [](auto&, auto&) { return false; }, false);
    Outcome given_up{.failed = true, .sender = source, .text = "abandoned: given up after 1 attempt", .hops = {"a1"}};
    CHECK(oracle.came(given_up));
    given_up.text = "failed: the code threw";
    CHECK_FALSE(oracle.came(given_up));
    given_up.text = "abandoned: given up after 1 attempt";
    oracle.before({.verb = Verb::stop, .drone = "a1"});
    CHECK_FALSE(oracle.came(given_up));
    given_up.hops = {"a2"};
    CHECK(oracle.came(given_up));
    given_up.hops = {source};  // of a group
    CHECK_FALSE(oracle.came(given_up));
}

TEST_CASE("why: a reason that cannot be true is a problem when nothing moves")
{
    const auto after = [](Reason why, auto change) {
        auto statuses = working();
        tick_edge(statuses).why = why;
        change(statuses);
        return with_false_reason(statuses);
    };
    const auto as_it_is = [](Statuses&) {};
    const auto idle = [](Statuses& statuses) {
        image_input(statuses).queued = image_input(statuses).in_hand = 0;
        result_edge(statuses).events.went(Fate::acknowledged);
    };
    CHECK(after(Reason::not_asked, as_it_is).empty());
    CHECK(is_of(after(Reason::not_asked, idle), "why"));
    CHECK(is_of(after(Reason::not_acknowledged, idle), "why"));
    CHECK(after(Reason::not_asked, [&](Statuses& statuses) {
              idle(statuses);
              statuses.at("a1").why = Reason::halted;
          }).empty());
    CHECK(is_of(after(Reason::lane_full, as_it_is), "why"));
    CHECK(after(Reason::lane_full, [](Statuses& statuses) { statuses.erase("a1"); }).empty());  // frozen
    CHECK(is_of(after(Reason::place_kept, as_it_is), "why"));
    CHECK(after(Reason::place_kept, [](Statuses& statuses) {
              tick_edge(statuses).connected = image_input(statuses).connected = false;
          }).empty());
}
