// The pauses between attempts.
#include <hive/backoff.hpp>

#include <doctest/doctest.h>

using hive::Backoff;
using namespace std::chrono_literals;

TEST_CASE("backoff: pauses double up to the most, and begin anew after a success")
{
    Backoff backoff(500ms, 10s);
    for (const auto pause : {500ms, 1000ms, 2000ms, 4000ms, 8000ms, 10000ms, 10000ms})
        CHECK(backoff.next() == pause);
    backoff.reset();
    CHECK(backoff.next() == 500ms);
}

TEST_CASE("backoff: with a seed each pause is within half of itself, and the same for the same seed")
{
    Backoff one(100ms, 5s, 7);
    Backoff same(100ms, 5s, 7);
    Backoff other(100ms, 5s, 8);
    bool differs = false;
    for (int i = 0; i < 100; ++i) {
        const auto middle = std::min(5000.0, 100.0 * (1LL << std::min(i, 30)));
        const auto pause = one.next();
        CHECK(pause.count() >= middle / 2 - 1);
        CHECK(pause.count() <= middle * 3 / 2);
        CHECK(pause == same.next());
        differs = differs || pause != other.next();
    }
    CHECK(differs);
    one.reset();
    CHECK(one.next() <= 150ms);
    CHECK(Backoff(100ms, 5s, 0).next() >= 50ms);
}
