// How often a peer may cause something.
#include <hive/event/rate_limits.hpp>

#include <doctest/doctest.h>

using namespace std::chrono_literals;
using hive::event::Clock;
using hive::event::RateLimits;

TEST_CASE("rate limits: each peer has its own, and the next that passes says how many were kept back")
{
    RateLimits limits(10, 1s);
    const Clock::time_point begin{};
    int passed = 0;
    for (int i = 0; i < 1000; ++i)
        passed += limits.pass("pid 1", begin + i * 900us) ? 1 : 0;
    CHECK(passed == 10);
    CHECK(limits.pass("pid 2", begin) == 0);  // its own ten
    CHECK(limits.pass("pid 1", begin + 1s) == 990);
    CHECK(limits.pass("pid 1", begin + 1s) == 0);
}

TEST_CASE("rate limits: a time that is over is forgotten, and a peer begins again")
{
    RateLimits limits(2, 10s);
    const Clock::time_point begin{1h};
    CHECK(limits.pass("", begin) == 0);
    CHECK(limits.pass("", begin + 1s) == 0);
    for (int i = 0; i < 1000; ++i)
        CHECK_FALSE(limits.pass("", begin + 2s));
    CHECK_FALSE(limits.pass("", begin + 9s));
    CHECK(limits.pass("", begin + 10s) == 1001);
}

TEST_CASE("rate limits: keeps no book of peers that have gone")
{
    RateLimits limits(10, 1s);
    for (int i = 0; i < 100'000; ++i)
        CHECK(limits.pass("pid " + std::to_string(i), Clock::time_point{} + i * 1ms));
}
