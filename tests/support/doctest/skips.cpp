// Cases for skips.sh, which checks the exit codes of possible.hpp.
#include <doctest/doctest.h>
#include <possible.hpp>

using hive::test::possible;

TEST_CASE("skipped") { static_cast<void>(possible("nothing that there is")); }
TEST_CASE("also skipped") { static_cast<void>(possible("nothing that there is")); }
TEST_CASE("passed") { CHECK(possible("")); }
TEST_CASE("failed") { CHECK(false); }
TEST_CASE("failed, then skipped")
{
    CHECK(false);
    static_cast<void>(possible("nothing that there is"));
}
TEST_CASE("one part skipped")
{
    SUBCASE("this one") { static_cast<void>(possible("nothing that there is")); }
    SUBCASE("not this one") { CHECK(true); }
}
