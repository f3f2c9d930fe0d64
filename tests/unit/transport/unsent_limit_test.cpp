// How much the kernel may hold unsent, by the rate of the way.
#include "unsent_limit.hpp"

#include <doctest/doctest.h>

using hive::transport::unsent_limit, hive::transport::UnsentLimit;

TEST_CASE("unsent limit: what a way carries in 50 ms, never too little to go on nor more than gigabit Ethernet needs")
{
    CHECK(unsent_limit(70e3) == UnsentLimit::least);
    CHECK(unsent_limit(1e6) == 50'000);
    CHECK(unsent_limit(125e6) == UnsentLimit::most);
    CHECK(unsent_limit(0) == UnsentLimit::least);
    CHECK(unsent_limit(1e300) == UnsentLimit::most);
}
