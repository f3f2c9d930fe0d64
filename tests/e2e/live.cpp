// Live cameras: a slow receiver does not affect others, no receiver gets more than it can process, and watching is
// free.
#include "measure.hpp"
#include "status_sums.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <cmath>
#include <csignal>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// Time between two results, in seconds: the median, which is robust against stalls of the machine.
double gap_of(const std::vector<Clock::time_point>& times)
{
    if (times.size() < 3)
        throw std::runtime_error("too few events came to tell how far they are apart");
    std::vector<double> gaps;
    for (std::size_t i = 1; i < times.size(); ++i)
        gaps.push_back(std::chrono::duration<double>(times[i] - times[i - 1]).count());
    return median(std::move(gaps));
}

/// The age of the event at its arrival: its age after processing, minus its waiting and processing time.
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
    const auto worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    const auto collector = application.collect({{"worker", "result"}});
    application.connect({"camera", ""}, {"worker", ""});
    std::vector<double> at_once;  // ages of events with no earlier one waiting: the time to draw, encode and send one
    for (int i = 0; i < 30; ++i) {
        const auto result = collector->next(patient(5000ms));
        REQUIRE(result);
        at_once.push_back(age_at_arrival_ms(*result));
    }
    const double cost = median(at_once);
    application.set("worker", {{"work_ms", 100}});
    arrivals(*collector, 300ms);

    std::vector<double> made, sent, middle, most;
    for (int window = 0; window < 3; ++window) {
        const auto begin = Clock::now();
        const auto before = edge_to(application.status("camera"), "worker.image").events;
        std::vector<double> ages;
        while (Clock::now() - begin < 4s)
            if (const auto result = collector->next(100ms))
                ages.push_back(age_at_arrival_ms(*result));
        const auto after = edge_to(application.status("camera"), "worker.image").events;
        const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        const auto grown = [&](hive::Fate fate) {
            return static_cast<double>(after.of(fate) - before.of(fate)) / seconds;
        };
        made.push_back(static_cast<double>(after.total() - before.total()) / seconds);
        sent.push_back(grown(hive::Fate::acknowledged));
        REQUIRE_FALSE(ages.empty());
        std::ranges::sort(ages);
        middle.push_back(median(ages));
        most.push_back(ages[ages.size() * 9 / 10]);
        MESSAGE(made.back(), " images/s made, ", sent.back(), " sent, ", grown(hive::Fate::skipped),
                " skipped; median age at arrival ", middle.back(), " ms, of a worker that waits for them ", cost,
                " ms");
        CHECK(sent.back() <= 10.5);
        CHECK(after.of(hive::Fate::dropped) == 0);
    }
    if (sanitized())
        return;
    CHECK(median(made) > 0.95 * 30);
    CHECK(median(sent) > 9);
    // The newest is at most one period old, plus the time to draw, encode and send it; the one before is a period
    // older.
    CHECK(median(middle) < 1000.0 / 30 + 10 + cost);
    CHECK(median(most) < 1000.0 / 30 + 20 + cost);
}

TEST_CASE("slow receivers: at 30, 10 and 1 fps and one stopped, each keeps its own rate, and the camera at most two "
          "images for each")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"fps=30"});
    constexpr std::size_t image = 640 * 480 * 3;
    const auto fast = swarm.drone("sleeper", "fast"), slow = swarm.drone("sleeper", "slow", {"work_ms=100"}),
               slowest = swarm.drone("sleeper", "slowest", {"work_ms=1000"}),
               stopped = swarm.drone("sleeper", "stopped", {"work_ms=100"});
    auto application = swarm.application();
    const auto collector = application.collect({{"fast", ""}, {"slow", ""}, {"slowest", ""}});
    for (const std::string receiver : {"fast", "slow", "slowest", "stopped"})
        application.connect({"camera", ""}, {receiver, ""});
    arrivals(*collector, 1500ms);
    const auto usual = arrivals(*collector, 5500ms);
    const auto before = resident_bytes(camera.pid());
    stopped.signal(SIGSTOP);
    const auto came = arrivals(*collector, sanitized() ? 3000ms : 8500ms);
    const auto now = resident_bytes(camera.pid());
    const std::size_t grown = std::max(now, before) - before;
    stopped.signal(SIGCONT);
    MESSAGE("fast ", rate_of(came.at("fast")), ", slow ", rate_of(came.at("slow")), ", slowest ",
            rate_of(came.at("slowest")), " events/s; the camera grew by ", grown / 1024, " KiB, an image has ",
            image / 1024);
    if (!sanitized()) {
        const auto keeps_its_rate = [&](const std::string& receiver, double events_per_second) {
            CAPTURE(receiver);
            const double gap = gap_of(usual.at(receiver));
            CHECK(std::abs(gap * events_per_second - 1) < 0.2);  // it needs some time besides its work
            CHECK(std::abs(gap_of(came.at(receiver)) / gap - 1) < 0.05);
        };
        keeps_its_rate("fast", 30);
        keeps_its_rate("slow", 10);
        keeps_its_rate("slowest", 1);
        CHECK(grown <= 4 * 2 * image);
    }
    // It recovers by itself when it continues.
    const auto done = [&] { return at_inputs(application.status("stopped"), &hive::InputStatus::processed); };
    const auto at_stop = done();
    CHECK(eventually([&] { return done() > at_stop + 2; }));
}

TEST_CASE(
    "watching: three hivectl top and three receivers of notifications change the rate of a swarm by less than 1 %")
{
    if (!possible(missing_if_sanitized()))
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
    // Alternates runs with and without, and compares pairs, so that other load affects both equally.
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
    // The change must not exceed the normal variation.
    std::vector<double> by_itself;
    for (std::size_t i = 1; i < alone.size(); ++i)
        by_itself.push_back(std::abs(alone[i] / alone[i - 1] - 1));
    MESSAGE("alone, the rate changes by ", median(by_itself), " of it from one round to the next");
    CHECK(median(ratio) > 0.99 - median(by_itself));
    for (const auto& name : names)
        CHECK(at_inputs(application.status(name), &hive::InputStatus::received) > 100);
}

TEST_CASE("replace: of a camera of 30 fps that a face finder works on, at most two frames are skipped")
{
    if (!possible(missing_if_sanitized()))
        return;  // a measurement
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"fps=30", "width=320"});
    swarm.hivectl_done({"start", "face"});
    auto application = swarm.application();
    const auto collector = application.collect({{"face", "faces"}});
    application.connect({"camera", "image"}, {"face", "image"});
    std::int64_t last = 0;
    const auto longest_gap = [&](const std::function<bool()>& over) {
        std::int64_t gap = 0;
        for (const auto end = Clock::now() + 20s; !over() && Clock::now() < end;)
            if (const auto event = collector->next(20ms)) {
                gap = std::max(gap, last == 0 ? 0 : event->identity.sequence - last - 1);
                last = event->identity.sequence;
            }
        return gap;
    };
    const auto gap_within = [&](Milliseconds time) {
        const auto end = Clock::now() + time;
        return longest_gap([&] { return Clock::now() >= end; });
    };
    for (const double fps : {30.0, 15.0, 8.0}) {  // as fast as this machine finds faces in all frames
        application.set("camera", {{"fps", fps}});
        gap_within(700ms);
        const auto missing = gap_within(1500ms);
        MESSAGE(fps, " fps: ", missing, " skipped without a replacement");
        if (missing == 0)
            break;
    }
    std::vector<std::int64_t> skipped;
    for (int i = 0; i < 7; ++i) {
        gap_within(300ms);
        const auto usual = gap_within(700ms);
        auto command = swarm.hivectl_running({"replace", "face"}, "replace");
        std::optional<Clock::time_point> ended;
        const auto longest = longest_gap([&] {
            if (!ended && command.wait(0ms))
                ended = Clock::now();
            return ended && Clock::now() > *ended + 200ms;
        });
        skipped.push_back(longest - usual);
        CHECK(command.wait(0ms) == 0);
    }
    for (const auto count : skipped)
        MESSAGE(count, " more skipped than before");
    CHECK(median(skipped) <= 2);
}
