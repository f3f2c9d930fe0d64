// How many lines strangers can make a module write.
#include <hive/event/log_limit.hpp>

#include <doctest/doctest.h>

using namespace std::chrono_literals;
using hive::event::Clock;
using hive::event::LogLimit;

TEST_CASE("log limit: so many lines in so long, and the next one tells how many were kept back")
{
    LogLimit limit(2, 10s);
    const Clock::time_point begin{1h};
    CHECK(limit.pass("first", begin) == "first");
    CHECK(limit.pass("second", begin + 1s) == "second");
    for (int i = 0; i < 1000; ++i)
        CHECK_FALSE(limit.pass("more", begin + 2s));
    CHECK_FALSE(limit.pass("more", begin + 9s));
    CHECK(limit.pass("later", begin + 10s) == "later (and 1001 more lines like it)");
    CHECK(limit.pass("again", begin + 11s) == "again");
    CHECK_FALSE(limit.pass("more", begin + 12s));
}
