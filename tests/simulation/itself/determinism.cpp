// A history depends only on its seed.
#include <simulation.hpp>

#include <doctest/doctest.h>

using namespace hive;

namespace {

std::uint64_t digest_of(std::uint64_t seed, const std::set<std::string>& faults = {})
{
    const auto played = simulation::play(mixtures::make_plan(seed, 8, faults));
    CHECK(played.handlers > 100);
    return played.digest;
}

}  // namespace

TEST_CASE("the same seed gives the same history, alone and after others; another seed gives another one")
{
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const auto first = digest_of(seed), again = digest_of(seed);
        const auto other = digest_of(seed + 1000), once_more = digest_of(seed);
        CHECK(again == first);
        CHECK(once_more == first);
        CHECK(other != first);
    }
}

TEST_CASE("the same seed gives the same history with every fault")
{
    for (const auto& fault : mixtures::fault::all)
        for (std::uint64_t seed = 1; seed <= 2; ++seed) {
            CAPTURE(fault);
            const auto first = digest_of(seed, {fault});
            digest_of(seed + 1000, {fault});
            CHECK(digest_of(seed, {fault}) == first);
        }
}
