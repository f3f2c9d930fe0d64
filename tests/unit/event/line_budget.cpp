// Lines of the log that others cause.
#include <hive/event/line_budget.hpp>

#include <doctest/doctest.h>

using namespace std::chrono_literals;
using hive::LogLevel;
using hive::event::Clock;
using hive::event::LineBudget;

TEST_CASE(
    "line budget: ten lines a second for each peer and level; the next that is written says how many were left out")
{
    LineBudget lines;
    const Clock::time_point begin{};
    int written = 0;
    for (int i = 0; i < 1000; ++i)
        written += lines.ask(LogLevel::warning, "pid 1", begin + i * 900us) ? 1 : 0;
    CHECK(written == 10);
    CHECK(lines.ask(LogLevel::warning, "pid 2", begin) == 0);  // its own ten
    CHECK(lines.ask(LogLevel::warning, "pid 1", begin + 1s) == 990);
    CHECK(lines.ask(LogLevel::warning, "pid 1", begin + 1s) == 0);
}

TEST_CASE("line budget: no line keeps back one of another level")
{
    LineBudget lines;
    for (int i = 0; i < 1000; ++i)
        lines.ask(LogLevel::debug, "pid 1", Clock::time_point{});
    CHECK(lines.ask(LogLevel::error, "pid 1", Clock::time_point{}) == 0);
    CHECK_FALSE(lines.ask(LogLevel::debug, "pid 1", Clock::time_point{}));
}

TEST_CASE("line budget: keeps no book of peers that have gone")
{
    LineBudget lines;
    for (int i = 0; i < 100'000; ++i)
        CHECK(lines.ask(LogLevel::warning, "pid " + std::to_string(i), Clock::time_point{} + i * 1ms));
}
