// Live cameras: nobody's slowness costs anybody else, nothing is sent that nobody can process, and watching is free.
#include "measure.hpp"
#include "status_sums.hpp"

#include <doctest/doctest.h>

#include <csignal>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// How old the event was when the worker began with it: its age when the work was done, less what it waited and took
/// there.
double age_at_arrival_ms(const hive::Event& result)
{
    const auto& hop = result.identity.hops.back();
    return static_cast<double>(result.header.at("age_us").get<std::int64_t>() - hop.wait_us - hop.work_us) / 1000;
}

}  // namespace

TEST_CASE(
    "sync: a camera of 30 fps sends a receiver of 100 ms at most 10.5 images a second, each the newest when it asked")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"fps=30"});
    const auto worker = swarm.drone("sleeper", "worker", {"work_ms=100"});
    auto application = swarm.application();
    const auto collector = application.collect({{"worker", "result"}});
    application.connect({"camera", ""}, {"worker", ""});
    REQUIRE(collector->next(patient(5000ms)));

    const auto before = edge_to(application.status("camera"), "worker.image").events;
    const auto begin = Clock::now();
    std::vector<double> ages;
    while (Clock::now() - begin < 4s)
        if (const auto result = collector->next(100ms))
            ages.push_back(age_at_arrival_ms(*result));
    const auto after = edge_to(application.status("camera"), "worker.image").events;
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    const auto grown = [&](hive::Fate fate) { return static_cast<double>(after.of(fate) - before.of(fate)) / seconds; };
    const double came = static_cast<double>(after.total() - before.total()) / seconds;
    MESSAGE(came, " images/s made, ", grown(hive::Fate::acknowledged), " sent, ", grown(hive::Fate::skipped),
            " skipped; median age at arrival ", median(ages), " ms");
    CHECK(grown(hive::Fate::acknowledged) <= 10.5);
    CHECK(after.of(hive::Fate::dropped) == 0);
    if (sanitized())
        return;
    CHECK(came > 0.95 * 30);
    CHECK(grown(hive::Fate::acknowledged) > 9);
    // The newest is at most one period old, and what it takes to draw, encode and send it; the one before it is a
    // period older.
    CHECK(median(ages) < 1000.0 / 30 + 10);
    std::ranges::sort(ages);
    CHECK(ages[ages.size() * 9 / 10] < 1000.0 / 30 + 20);
}

TEST_CASE("slow receivers: at 30, 10 and 1 fps and one stopped, each keeps its own rate, and the camera at most two "
          "pictures for each")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"fps=30"});
    constexpr std::size_t picture = 640 * 480 * 3;
    const auto fast = swarm.drone("sleeper", "fast"), slow = swarm.drone("sleeper", "slow", {"work_ms=100"}),
               slowest = swarm.drone("sleeper", "slowest", {"work_ms=1000"}),
               stopped = swarm.drone("sleeper", "stopped", {"work_ms=100"});
    auto application = swarm.application();
    const auto collector = application.collect({{"fast", ""}, {"slow", ""}, {"slowest", ""}});
    for (const std::string receiver : {"fast", "slow", "slowest", "stopped"})
        application.connect({"camera", ""}, {receiver, ""});
    arrivals(*collector, 1500ms);
    const auto before = resident_bytes(camera.pid());
    stopped.signal(SIGSTOP);
    const auto came = arrivals(*collector, sanitized() ? 3000ms : 8500ms);
    const auto now = resident_bytes(camera.pid());
    const std::size_t grown = std::max(now, before) - before;
    stopped.signal(SIGCONT);
    MESSAGE("fast ", rate_of(came.at("fast")), ", slow ", rate_of(came.at("slow")), ", slowest ",
            rate_of(came.at("slowest")), " events/s; the camera grew by ", grown / 1024, " KiB, a picture has ",
            picture / 1024);
    if (!sanitized()) {
        CHECK(rate_of(came.at("fast")) == doctest::Approx(30).epsilon(0.05));
        CHECK(rate_of(came.at("slow")) == doctest::Approx(10).epsilon(0.05));
        CHECK(rate_of(came.at("slowest")) == doctest::Approx(1).epsilon(0.05));
        CHECK(grown <= 4 * 2 * picture);
    }
    // It goes on by itself when it goes on.
    const auto done = [&] { return at_inputs(application.status("stopped"), &hive::InputStatus::processed); };
    const auto at_stop = done();
    CHECK(eventually([&] { return done() > at_stop + 2; }));
}

TEST_CASE(
    "watching: three hivectl top and three receivers of notifications change the rate of a swarm by less than 1 %")
{
    if (sanitized())
        return;  // a measurement
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "bytes=100000"});
    const auto worker = swarm.drone("sleeper", "worker", {"work_ms=40"});
    const std::vector<std::string> names{"watcher-1", "watcher-2", "watcher-3"};
    std::vector<Process> watchers;
    for (const auto& name : names)
        watchers.push_back(swarm.drone("sleeper", name));
    auto application = swarm.application();
    const auto collector = application.collect({{"worker", "result"}});
    application.connect({"source", ""}, {"worker", ""}, {.window = 2, .group = {}, .lease = {}});
    const auto watch = [&] {
        std::vector<Process> tops;
        for (const auto& name : names) {
            tops.push_back(swarm.hivectl_running({"top"}, "top-of-" + name));
            application.connect({"source", "tick"}, {name, "image"},
                                {.delivery = hive::Delivery::notification, .group = {}, .lease = {}});
        }
        return tops;
    };
    // With and without take turns, and each pair is compared, so that what else the machine does meets both alike.
    std::vector<double> alone, watched, ratio;
    for (int round = 0; round < 9; ++round) {
        rate(*collector, 1, 5);
        alone.push_back(rate(*collector, 1, 25));
        auto tops = watch();
        rate(*collector, 1, 5);
        watched.push_back(rate(*collector, 1, 25));
        ratio.push_back(watched.back() / alone.back());
        for (auto& top : tops) {
            CHECK_FALSE(top.wait(0ms));  // they did watch
            top.kill();
        }
        for (const auto& name : names)
            application.disconnect({"source", ""}, {name, ""});
    }
    MESSAGE("alone ", median(alone), ", watched ", median(watched), " events/s, median of their ratios ", median(ratio),
            " (9 rounds)");
    CHECK(median(ratio) > 0.99);
    for (const auto& name : names)
        CHECK(at_inputs(application.status(name), &hive::InputStatus::received) > 100);
}
