// Ranges and due times of a replay.
#include "files.hpp"
#include "playback.hpp"

#include <doctest/doctest.h>

using namespace record_test;
using namespace std::chrono_literals;
using replay::Playback;
using replay::Timeline;

namespace {

std::vector<std::int64_t> times(Playback& playback, bool again, std::size_t most)
{
    std::vector<std::int64_t> result;
    for (; playback.current() && result.size() < most; playback.advance(again))
        result.push_back(playback.current()->prefix.time_us / 1000);
    return result;
}

}  // namespace

TEST_CASE("playback: a range has its start and end, once or in a loop")
{
    const Folder folder;
    record(folder / "a", 30);
    Playback part(folder / "a", {1'250'000, 1'600'000});
    CHECK(times(part, false, 100) == std::vector<std::int64_t>{1300, 1400, 1500});
    Playback again(folder / "a", {2'750'000, 0});
    CHECK(times(again, true, 5) == std::vector<std::int64_t>{2800, 2900, 2800, 2900, 2800});
    Playback nothing(folder / "a", {60'000'000, 0});
    CHECK(times(nothing, true, 5).empty());
    Playback all(folder / "a", {});
    CHECK(times(all, false, 100).size() == 30);
}

TEST_CASE("playback: the first event comes again as long after the last as the events are apart, and a turn takes at "
          "least 100 ms")
{
    const auto pause = [](const fs::path& file, const replay::Range& range) {
        Playback playback(file, range);
        for (;;)
            if (const auto us = playback.advance(true); us > 0)
                return us;
    };
    const Folder folder;
    record(folder / "a", 30);
    CHECK(pause(folder / "a", {}) == 100'000);
    record(folder / "one", 1);
    CHECK(pause(folder / "one", {}) == 100'000);
    {
        hive::recording::Writer writer(settings(folder / "pair"));
        append(writer, 0);
        append(writer, 1, Clock::time_point{} - 80ms);
        writer.finish("stopped");
    }
    CHECK(pause(folder / "pair", {}) == 80'000);
    Playback once(folder / "one", {});
    CHECK(once.advance(false) == 0);
    CHECK_FALSE(once.current());
}

TEST_CASE("timeline: an event after a restart is due after the pause, divided by the speed")
{
    Timeline timeline;
    const Timeline::Clock::time_point now{100s};
    CHECK(timeline.due(0, 2, now) == now);
    timeline.restart(100'000);
    CHECK(timeline.due(0, 2, now) == now + 50ms);
    CHECK(timeline.due(0, 2, now + 10ms) == now + 50ms);
    CHECK(timeline.due(1'000'000, 2, now + 50ms) == now + 550ms);
}

TEST_CASE("timeline: events are due as far apart as they came, divided by the speed")
{
    Timeline timeline;
    const Timeline::Clock::time_point now{100s};
    CHECK(timeline.due(5'000'000, 2, now) == now);
    CHECK(timeline.due(6'000'000, 2, now + 1ms) == now + 500ms);
    CHECK(timeline.due(9'000'000, 2, now + 500ms) == now + 2s);
}

TEST_CASE("timeline: neither a pause nor a jump back is followed by a burst")
{
    Timeline timeline;
    const Timeline::Clock::time_point now{100s};
    timeline.due(0, 1, now);
    CHECK(timeline.due(1'000'000, 1, now + 1900ms) == now + 1s);  // a little late is made up for
    CHECK(timeline.due(2'000'000, 1, now + 60s) == now + 60s);
    CHECK(timeline.due(3'000'000, 1, now + 60s) == now + 61s);
    CHECK(timeline.due(0, 1, now + 61s) == now + 61s);
    CHECK(timeline.due(500'000, 1, now + 61s) == now + 61500ms);
    CHECK(timeline.due(1'500'000, 10, now + 61500ms) == now + 61500ms);  // another speed counts from here
}

TEST_CASE("timeline: a time beyond any clock is due in years at any speed")
{
    Timeline timeline;
    const Timeline::Clock::time_point now{};
    CHECK(timeline.due(0, 0.01, now) == now);
    CHECK(timeline.due(hive::recording::most_time_us, 0.01, now) > now + std::chrono::hours(24 * 365 * 20));
}
