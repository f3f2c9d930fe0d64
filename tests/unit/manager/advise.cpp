// What the model of advise predicts from measured values.
#include "advise/line.hpp"
#include "advise/trace.hpp"

#include <doctest/doctest.h>

#include <algorithm>

namespace hive::advising {
namespace {

/// A camera of so many events per second, and a worker that takes this long for each.
Line line(double fps, double work_us)
{
    Stage camera{
        .members = {"camera"}, .hosts = {{"local", 1}}, .host = "local", .per_s = fps, .work_us = 100, .age_us = 0};
    Stage worker{.members = {"face"}, .hosts = {{"local", 1}}, .host = "local", .work_us = work_us, .age_us = work_us};
    worker.per_s = std::min(fps, second_us / work_us);
    worker.can_share = true;
    worker.saturated = worker.per_s < fps;
    worker.from = "camera.image";
    worker.to = "face.image";
    Line line{.stages = {camera, worker}};
    line.machines["local"] = {.processors = 4, .busy = 0.5};
    return line;
}

const Candidate* proposed(const std::vector<Candidate>& candidates, Proposal::What what)
{
    const auto found = std::ranges::find(candidates, what, [](const Candidate& each) { return each.change.what; });
    return found == candidates.end() ? nullptr : &*found;
}

}  // namespace

TEST_CASE("advise: one more worker doubles the rate, up to that of the source")
{
    auto slow = line(100, 50'000);
    fit(slow);
    CHECK(limits(slow).front().what == Station::What::work);
    CHECK(limits(slow).at(1).what == Station::What::source);
    const auto all = candidates(slow, Goal::fps);
    const auto* worker = proposed(all, Proposal::What::worker);
    REQUIRE(worker);
    CHECK(worker->proposal.predicted_per_s == doctest::Approx(40));
    CHECK(worker->proposal.sure == Proposal::Sure::high);

    auto nearly = line(30, 50'000);
    fit(nearly);
    const auto some = candidates(nearly, Goal::fps);
    REQUIRE(proposed(some, Proposal::What::worker));
    CHECK(some.front().proposal.predicted_per_s == doctest::Approx(30));
    CHECK(some.front().proposal.next->what == Station::What::source);

    auto fast = line(10, 50'000);
    fit(fast);
    CHECK(candidates(fast, Goal::fps).empty());
    CHECK(limits(fast).front().what == Station::What::source);

    slow.stages[1].can_share = false;
    CHECK(candidates(slow, Goal::fps).empty());
}

TEST_CASE("advise: an event of each member that is missing in a short measurement is not time on the connection")
{
    auto shared = line(100, 100'000);
    auto& workers = shared.stages[1];
    workers.members = {"face", "face-2"};
    workers.per_s = 16;  // in half a second 8 of 10
    fit(shared);
    CHECK(limits(shared).front().what == Station::What::window);
    shared.time_us = 500'000;
    fit(shared);
    CHECK(limits(shared).front().what == Station::What::work);
    CHECK(limits(shared).front().max_per_s == doctest::Approx(20));
    workers.per_s = 10;
    fit(shared);
    CHECK(limits(shared).front().what == Station::What::window);
}

TEST_CASE("advise: if processors are full, one more worker that computes gives nothing, and one that sleeps doubles")
{
    auto full = line(100, 50'000);
    full.machines["local"] = {.processors = 2, .busy = 2, .drones = {{"busy", 1.4}}};
    full.stages[1].cpu_us = 30'000;  // it waits for a processor, too
    fit(full);
    const auto all = candidates(full, Goal::fps);
    CHECK_FALSE(proposed(all, Proposal::What::worker));
    const auto* halt = proposed(all, Proposal::What::halt);
    REQUIRE(halt);
    CHECK(halt->change.name == "busy");
    CHECK(halt->proposal.predicted_per_s == doctest::Approx(1e6 / 30'000));
    CHECK(halt->proposal.sure == Proposal::Sure::medium);

    full.machines["gpu1"] = {.processors = 8, .busy = 1, .ssh = "gpu1"};
    const auto elsewhere = candidates(full, Goal::fps);
    const auto* machine = proposed(elsewhere, Proposal::What::machine);
    REQUIRE(machine);
    CHECK(machine->change.name == "gpu1");
    CHECK(machine->proposal.predicted_per_s == doctest::Approx(40));
    CHECK(machine->proposal.sure == Proposal::Sure::low);

    full.stages[1].cpu_us = 100;
    const auto sleeps = candidates(full, Goal::fps);
    REQUIRE(proposed(sleeps, Proposal::What::worker));
    CHECK(sleeps.front().proposal.predicted_per_s == doctest::Approx(40));
}

TEST_CASE("advise: a window as wide as the round trip lets the rate of the source through")
{
    auto far = line(30, 10'000);
    auto& stage = far.stages[1];
    stage.remote = true;
    stage.round_trip_us = 90'000;
    stage.per_s = 10;
    stage.saturated = true;
    stage.can_share = false;
    fit(far);
    CHECK(stage.transit_us == doctest::Approx(0));
    CHECK(limits(far).front().what == Station::What::window);
    CHECK(limits(far).front().max_per_s == doctest::Approx(10));
    const auto all = candidates(far, Goal::fps);
    REQUIRE(all.size() == 1);
    CHECK(all[0].change.what == Proposal::What::window);
    CHECK(all[0].change.window == 4);
    CHECK(all[0].proposal.predicted_per_s == doctest::Approx(30));
}

TEST_CASE("advise: on a full connection a wider window gives little, and smaller bodies give what they save")
{
    auto narrow = line(30, 5'000);
    auto& stage = narrow.stages[1];
    stage.remote = true;
    stage.round_trip_us = 5'000;
    stage.per_s = 5;  // 190 ms on the connection
    stage.saturated = true;
    stage.can_share = false;
    stage.bytes = 900'000;
    fit(narrow);
    CHECK(stage.transit_us == doctest::Approx(190'000));
    narrow.as_jpeg[1] = {.bytes = 90'000, .encode_us = 1'000};
    const auto all = candidates(narrow, Goal::fps);
    REQUIRE(proposed(all, Proposal::What::encoding));
    CHECK(all.front().change.encoding == "jpeg");
    CHECK(all.front().proposal.predicted_per_s == doctest::Approx(30));
    if (const auto* window = proposed(all, Proposal::What::window))
        CHECK(window->proposal.predicted_per_s <= 1e6 / 190'000 + 0.01);
}

TEST_CASE("advise: a filter divides the rate for what follows, and what comes before has to be as much faster")
{
    auto filtered = line(100, 50'000);  // 20 of 100
    filtered.stages[1].pass = 0.25;
    Stage last{.members = {"last"}, .hosts = {{"local", 1}}, .host = "local", .per_s = 5, .work_us = 10'000};
    last.from = "face.faces";
    last.to = "last.faces";
    filtered.stages.push_back(last);
    fit(filtered);
    const auto all = limits(filtered);
    CHECK(all[0].what == Station::What::work);
    CHECK(all[0].at == "face");
    CHECK(all[0].max_per_s == doctest::Approx(5));
    CHECK(all[1].what == Station::What::source);
    CHECK(all[1].max_per_s == doctest::Approx(25));
    CHECK(all[2].max_per_s == doctest::Approx(100));
    CHECK(explains_rate(filtered));
    const auto found = candidates(filtered, Goal::fps);
    const auto* worker = proposed(found, Proposal::What::worker);
    REQUIRE(worker);
    CHECK(worker->change.stage == 1);
    CHECK(worker->proposal.predicted_per_s == doctest::Approx(10));
    CHECK(worker->proposal.sure == Proposal::Sure::medium);
}

TEST_CASE("advise: a drone with a second sender has its part of the time for this one")
{
    auto shared = line(100, 50'000);
    shared.stages[1].per_s = 10;  // and as many from the other sender
    shared.stages[1].share = 0.5;
    fit(shared);
    CHECK(shared.stages[1].transit_us == doctest::Approx(0));
    CHECK(limits(shared).front().what == Station::What::work);
    CHECK(limits(shared).front().max_per_s == doctest::Approx(10));
    const auto found = candidates(shared, Goal::fps);
    const auto* worker = proposed(found, Proposal::What::worker);
    REQUIRE(worker);
    CHECK(worker->proposal.predicted_per_s == doctest::Approx(20));
    CHECK(worker->proposal.sure == Proposal::Sure::medium);
}

TEST_CASE("advise: what waits in a queue is younger with a window of 1, or with a source that is not too fast")
{
    auto queued = line(100, 20'000);
    auto& stage = queued.stages[1];
    stage.options.window = 4;
    stage.queue_us = 60'000;
    stage.age_us = 85'000;
    queued.rate_parameter = "fps";
    fit(queued);
    const auto all = candidates(queued, Goal::latency);
    const auto* window = proposed(all, Proposal::What::window);
    REQUIRE(window);
    CHECK(window->change.window == 1);
    CHECK(window->proposal.predicted_us == doctest::Approx(25'000));
    const auto* source = proposed(all, Proposal::What::source_rate);
    REQUIRE(source);
    CHECK(source->change.fps == doctest::Approx(45));
    CHECK(source->proposal.predicted_us == doctest::Approx(20'000));
    CHECK(source->proposal.predicted_per_s == doctest::Approx(45));

    const auto steps = stations(queued);
    REQUIRE(steps.size() == 4);
    CHECK(steps[1].what == Station::What::waiting);
    CHECK(steps[1].time_us == doctest::Approx(5'000));
    CHECK(steps[2].what == Station::What::queue);
    CHECK(steps[3].what == Station::What::work);
    CHECK(candidates(line(10, 20'000), Goal::latency).empty());
}

TEST_CASE("advise: a way goes from the last drone to its source, and those that share a step are together")
{
    const auto drone = [](const std::string& name, std::vector<InputStatus> inputs) {
        return StatusAnswer{.drone = name, .status = Status{.name = name, .kind = name, .inputs = std::move(inputs)}};
    };
    const auto from = [](const std::string& end, const std::string& group, std::int64_t age_us) {
        InputStatus input{.input = "in", .from = end, .connected = true};
        input.options.group = group;
        input.last_age_us = age_us;
        return input;
    };
    const explaining::Look look{
        {drone("camera", {}), drone("other", {}), drone("alone", {}),
         drone("face-1", {from("camera.image", "camera", 10)}), drone("face-2", {from("camera.image", "camera", 10)}),
         drone("zones", {from("other.image", "", 5), from("face-1.faces", "", 50), from("face-2.faces", "", 50)})}};
    const auto ways = trace(look, {});
    REQUIRE(ways.size() == 1);
    REQUIRE(ways[0].size() == 3);
    CHECK(ways[0][0].members == std::vector<std::string>{"camera"});
    CHECK(ways[0][1].members == std::vector<std::string>{"face-1", "face-2"});
    CHECK(ways[0][2].members == std::vector<std::string>{"zones"});
    CHECK(trace(look, {"other", "zones"}).at(0).at(0).members == std::vector<std::string>{"other"});
    CHECK_THROWS_AS(trace(look, {"zones", "camera"}), Error);
    CHECK_THROWS_AS(trace(look, {"alone"}), Error);
    CHECK_THROWS_AS(trace(look, {"nobody"}), Error);
}

}  // namespace hive::advising
