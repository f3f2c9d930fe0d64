// The figures of the field, on a few frames that can be counted by hand.
#include "scoring.hpp"

#include <doctest/doctest.h>

using scoring::Identities;

namespace {

track::Track seen(std::int64_t id, double x)
{
    track::Track one;
    one.id = id;
    one.box = {x, 0, 10, 10};
    one.confirmed = true;
    return one;
}

scoring::TrueBox thing(int id, double x) { return {id, {x, 0, 10, 10}}; }

}  // namespace

TEST_CASE("scoring: tracks that keep to their things are worth everything")
{
    Identities score;
    for (int frame = 0; frame < 10; ++frame)
        score.add(std::vector{seen(7, 0), seen(9, 50)}, std::vector{thing(1, 0), thing(2, 51)}, 0.5);
    CHECK(score.mota() == 1);
    CHECK(score.idf1() == 1);
    CHECK(score.switches == 0);
}

TEST_CASE("scoring: a switch, a miss and a false track cost one each; IDF1 counts the longest track of each object")
{
    Identities score;
    const std::vector truth{thing(1, 0)};
    for (int frame = 0; frame < 6; ++frame)
        score.add(std::vector{seen(1, 0)}, truth, 0.5);
    for (int frame = 0; frame < 2; ++frame)
        score.add(std::vector{seen(2, 0)}, truth, 0.5);  // a switch, once
    score.add({}, truth, 0.5);                           // a miss
    score.add(std::vector{seen(2, 30)}, truth, 0.5);     // a miss and a false one
    CHECK(score.truths == 10);
    CHECK(score.covered == 8);
    CHECK(score.switches == 1);
    CHECK(score.false_tracks == 1);
    CHECK(score.mota() == doctest::Approx(1 - 4 / 10.0));
    CHECK(score.idf1() == doctest::Approx(2 * 6 / (10.0 + 9)));
}

TEST_CASE("scoring: an object keeps its track, even if another overlaps more; the others are paired at the optimum")
{
    Identities score;
    score.add(std::vector{seen(1, 0)}, std::vector{thing(1, 0)}, 0.3);
    score.add(std::vector{seen(1, 3), seen(2, 1)}, std::vector{thing(1, 0), thing(2, 4)}, 0.3);
    CHECK(score.switches == 0);
    CHECK(score.covered == 3);
    Identities fresh;
    fresh.add(std::vector{seen(1, 2), seen(2, 5)}, std::vector{thing(1, 3), thing(2, 0)},
              0.5);  // one after the other: 1
    CHECK(fresh.covered == 2);
}

TEST_CASE("scoring: tracks that are not confirmed or were not seen do not count")
{
    Identities score;
    track::Track young = seen(1, 0), missing = seen(2, 0);
    young.confirmed = false;
    missing.missing = 1;
    score.add(std::vector{young, missing}, std::vector{thing(1, 0)}, 0.5);
    CHECK(score.covered == 0);
    CHECK(score.false_tracks == 0);
    CHECK(Identities().mota() == 1);
    CHECK(Identities().idf1() == 1);
}
