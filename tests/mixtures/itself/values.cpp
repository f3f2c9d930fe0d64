// Which values may be found after sets.
#include "../values.hpp"

#include <doctest/doctest.h>

using namespace hive::mixtures;

namespace {

Values two()
{
    Values values;
    values.began("a", {1, 10});
    values.began("b", {1, 20});
    return values;
}

const std::vector<std::string> both{"a", "b"};

}  // namespace

TEST_CASE("mixtures: a confirmed set must be found, and a refused one must not")
{
    auto values = two();
    CHECK_FALSE(values.set({both, 5, {}}, Told::applied));
    CHECK_FALSE(values.found({{"a", {5, 10}}, {"b", {5, 20}}}));
    CHECK_FALSE(values.set({both, 15, {}}, Told::refused));
    CHECK(values.found({{"a", {5, 10}}, {"b", {15, 20}}}));
}

TEST_CASE("mixtures: an answer that cannot be is a problem")
{
    CHECK(two().set({both, 15, {}}, Told::applied));
    CHECK(two().set({both, 5, {}}, Told::refused));
}

TEST_CASE("mixtures: what is not known is all or nothing")
{
    for (const int work : {1, 5}) {
        auto values = two();
        CHECK_FALSE(values.set({both, 5, {}}, Told::unknown));
        CHECK_FALSE(values.found({{"a", {work, 10}}}));
        CHECK(values.found({{"b", {6 - work, 20}}}));
    }
}

TEST_CASE("mixtures: two sets at once are never mixed")
{
    const Change one{both, 5, 6}, other{both, 7, 8};
    auto values = two();
    values.set_both(one, Told::applied, other, Told::applied);
    CHECK(values.found({{"a", {5, 6}}, {"b", {7, 8}}}));
    values = two();
    values.set_both(one, Told::applied, other, Told::applied);
    CHECK_FALSE(values.found({{"a", {5, 6}}, {"b", {5, 6}}}));
    values = two();
    values.set_both(one, Told::refused, other, Told::applied);
    CHECK(values.found({{"a", {5, 6}}, {"b", {5, 6}}}));
}

TEST_CASE("mixtures: a drone that was killed in a set has the old values or the new, the others agree")
{
    for (const int work : {1, 5}) {
        auto values = two();
        CHECK_FALSE(values.set({both, 5, {}}, Told::unknown, "a"));
        CHECK_FALSE(values.found({{"b", {5, 20}}}));
        CHECK_FALSE(values.found({{"a", {work, 10}}}));
    }
    auto values = two();
    CHECK_FALSE(values.set({both, 5, {}}, Told::applied, "a"));
    CHECK(values.found({{"b", {1, 20}}}));
}

TEST_CASE("values: drones that are killed in a set again and again leave no more states than there are")
{
    Values values;
    for (const auto* drone : {"a1", "a2"})
        values.began(drone, {2, 8});
    for (int i = 0; i < 40; ++i) {
        const Change change{.drones = {"a1", "a2"}, .work_ms = 2 + i % 3, .most_ms = 8};
        CHECK_FALSE(values.set(change, Told::unknown, i % 2 == 0 ? "a1" : "a2"));
    }
    CHECK_FALSE(values.found({{"a1", {4, 8}}, {"a2", {2, 8}}}));
    CHECK(values.found({{"a1", {4, 8}}, {"a2", {3, 8}}}));
}
