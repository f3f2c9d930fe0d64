// Appearances: their difference, and their update.
#include <doctest/doctest.h>
#include <look.hpp>

using track::difference;
using track::Look;

TEST_CASE("look: nothing in common is 1, the same is 0, half in common is in between")
{
    CHECK(difference({1, 0}, {0, 1}).value() == doctest::Approx(1));
    CHECK(difference({0.5F, 0.5F}, {0.5F, 0.5F}).value() == doctest::Approx(0).epsilon(0.001));
    CHECK(difference({1, 0}, {0.5F, 0.5F}).value() == doctest::Approx(0.541).epsilon(0.01));
}

TEST_CASE("look: unknown or different kinds are not compared")
{
    CHECK_FALSE(difference({}, {}));
    CHECK_FALSE(difference({1, 0}, {}));
    CHECK_FALSE(difference({1, 0}, {1, 0, 0}));
    CHECK(track::look_of({0, 0}).empty());
    CHECK(track::look_of({1, 3}) == Look{0.25F, 0.75F});
}

TEST_CASE("look: it starts with the first observation, and follows others by its share")
{
    Look look;
    track::follow(look, {1, 0}, 0.1);
    CHECK(look == Look{1, 0});
    track::follow(look, {0, 1}, 0.25);
    CHECK(look == Look{0.75F, 0.25F});
    track::follow(look, {1, 0, 0}, 0.5);
    CHECK(look == Look{0.75F, 0.25F});
    track::follow(look, {}, 0.5);
    CHECK(look == Look{0.75F, 0.25F});
}
