// Tests how events are numbered whose source ends and continues.
#include "../numbering.hpp"

#include <doctest/doctest.h>

using namespace hive::mixtures;

namespace {

Outcome outcome(std::int64_t epoch, std::int64_t sequence, std::int64_t index)
{
    return {.failed = index == 0,
            .sender = "a1",
            .text = {},
            .epoch = epoch,
            .sequence = sequence,
            .hops = {},
            .index = index};
}

using Numbers = std::vector<std::pair<std::int64_t, std::int64_t>>;

Numbers numbers(const std::vector<Outcome>& outcomes)
{
    Numbers numbers;
    for (const auto& one : outcomes)
        numbers.emplace_back(one.epoch, one.sequence);
    return numbers;
}

}  // namespace

TEST_CASE("mixtures: events after an end are numbered on in the run of their source")
{
    Numbering numbering;
    numbering.began(100);
    CHECK(numbers(numbering.numbered({outcome(100, 1, 1), outcome(100, 2, 0)})) == Numbers{{100, 1}, {100, 2}});
    CHECK(numbers(numbering.numbered({outcome(150, 1, 0)})).empty());
    CHECK(numbers(numbering.numbered({outcome(150, 2, 4)})) == Numbers{{100, 3}, {100, 4}});
    numbering.began(200);
    CHECK(numbers(numbering.numbered({outcome(200, 1, 1), outcome(150, 3, 5)})) == Numbers{{200, 1}, {100, 5}});
}
