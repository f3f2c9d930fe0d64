// Lines of the log that others cause.
#include <hive/event/line_budget.hpp>

#include <doctest/doctest.h>

using namespace std::chrono_literals;
using hive::event::Clock;
using hive::event::LineBudget;

TEST_CASE("line budget: ten lines a second for each peer; the next that is written says how many were left out")
{
    LineBudget lines;
    const Clock::time_point begin{};
    int written = 0;
    for (int i = 0; i < 1000; ++i)
        written += lines.ask("pid 1", begin + i * 900us) ? 1 : 0;
    CHECK(written == 10);
    CHECK(lines.ask("pid 2", begin) == 0);  // its own ten
    CHECK(lines.ask("pid 1", begin + 1s) == 990);
    CHECK(lines.ask("pid 1", begin + 1s) == 0);
}

TEST_CASE("line budget: keeps no book of peers that have gone")
{
    LineBudget lines;
    for (int i = 0; i < 100'000; ++i)
        CHECK(lines.ask("pid " + std::to_string(i), Clock::time_point{} + i * 1ms));
}
