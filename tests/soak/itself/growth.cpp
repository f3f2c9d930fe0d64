// Memory and descriptors that grow, and such that do not.
#include "../growth.hpp"

#include <doctest/doctest.h>

using namespace hive::soak;

TEST_CASE("soak: a drone that keeps its size is no problem, also after a restart")
{
    Growth growth;
    for (const std::int64_t memory : {10 << 20, 14 << 20, 13 << 20, 9 << 20, 30 << 20})
        CHECK(growth.look({{"a1", {.memory = memory, .descriptors = 20}}}).empty());
}

TEST_CASE("soak: memory that grows slowly is a problem once it is too much")
{
    Growth growth;
    std::int64_t memory = 10 << 20;
    int looks = 0;
    for (; growth.look({{"a1", {.memory = memory, .descriptors = 20}}}).empty() && looks < 100; ++looks)
        memory += 1 << 20;
    CHECK(looks > 20);
    CHECK(looks < 30);
}

TEST_CASE("soak: descriptors that are left open are a problem")
{
    Growth growth;
    for (int look = 0; look < 3; ++look)
        CHECK(growth.look({{"a1", {.memory = 1, .descriptors = 20}}}).empty());
    CHECK(growth.look({{"a1", {.memory = 1, .descriptors = 36}}}).empty());
    CHECK(growth.look({{"a1", {.memory = 1, .descriptors = 37}}}).size() == 1);
}
