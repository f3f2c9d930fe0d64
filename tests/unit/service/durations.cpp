// The 99th percentile of durations, against exact ones.
#include "durations.hpp"

#include <doctest/doctest.h>

#include <random>
#include <vector>

using hive::service::Durations;

TEST_CASE("durations: the 99th percentile is at most an eighth too high, from nothing to hours")
{
    CHECK(Durations().p99_us() == 0);
    for (std::int64_t us = 1; us < 30'000'000'000; us = us + us / 7 + 1) {
        Durations one;
        one.add(us);
        CHECK(one.p99_us() >= us);
        CHECK(one.p99_us() <= us + us / 8);
    }
    Durations odd;
    odd.add(-5);  // the clock of a machine that was suspended
    CHECK(odd.p99_us() == 0);
    odd.add(std::int64_t{1} << 50);
    CHECK(odd.p99_us() == (std::int64_t{1} << 35) - 1);
}

TEST_CASE("durations: of a hundred calls one may be longer, two may not")
{
    Durations calls;
    for (int i = 0; i < 99; ++i)
        calls.add(10);
    calls.add(1'000'000);
    CHECK(calls.p99_us() == 10);
    calls.add(1'000'000);
    CHECK(calls.p99_us() >= 1'000'000);
}

TEST_CASE("durations: those of random calls are near the exact percentile")
{
    std::mt19937 random(7);
    std::lognormal_distribution<double> work(8, 1);
    std::vector<std::int64_t> exact;
    Durations calls;
    for (int i = 0; i < 1500; ++i) {
        exact.push_back(static_cast<std::int64_t>(work(random)));
        calls.add(exact.back());
    }
    std::ranges::sort(exact);
    const auto p99 = exact[exact.size() - 1 - exact.size() / 100];
    CHECK(calls.p99_us() >= p99);
    CHECK(calls.p99_us() <= p99 + p99 / 8);
}

TEST_CASE("durations: older calls are forgotten")
{
    Durations calls;
    for (int i = 0; i < 10'000; ++i)
        calls.add(50'000);
    for (int i = 0; i < 10'000; ++i)
        calls.add(100);
    CHECK(calls.p99_us() < 120);
    calls.add(50'000);
    CHECK(calls.p99_us() < 120);
}
