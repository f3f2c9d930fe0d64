// What was thrown, as an Error.
#include <hive/error.hpp>

#include <doctest/doctest.h>

#include <stdexcept>

namespace {

template <class Thrown>
hive::Error error_of(const Thrown& thrown)
{
    try {
        throw thrown;
    } catch (...) {
        return hive::current_error();
    }
}

}  // namespace

TEST_CASE("error: what was thrown keeps its code and its text, as far as it has them")
{
    const auto refused = error_of(hive::Error(hive::Errc::refused, "no"));
    CHECK(refused.code() == hive::Errc::refused);
    CHECK(refused.what() == std::string("no"));
    const auto other = error_of(std::runtime_error("broken"));
    CHECK(other.code() == hive::Errc::failed);
    CHECK(other.what() == std::string("broken"));
    const auto number = error_of(42);
    CHECK(number.code() == hive::Errc::failed);
    CHECK(number.what() == std::string("a non-exception object was thrown"));
}
