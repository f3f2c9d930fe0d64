// Results back in the order of the captures.
#include "reorder.hpp"

#include <doctest/doctest.h>

namespace hive {
namespace {

using namespace std::chrono_literals;
using Sequences = std::vector<std::int64_t>;

const Reorder::TimePoint start{};

Identity identity(std::int64_t sequence, bool lossless = true, std::int64_t epoch = 1)
{
    // Live shared work: the source skips two of three, the turns are without gaps.
    return {.source = "camera",
            .epoch = epoch,
            .sequence = lossless ? sequence : 3 * sequence,
            .lossless = lossless,
            .group = lossless ? "" : "workers",
            .turn = lossless ? 0 : sequence,
            .attempt = lossless ? 0 : 1};
}

void push(Reorder& reorder, std::initializer_list<std::int64_t> sequences, bool lossless = true,
          Reorder::TimePoint now = start)
{
    for (const auto sequence : sequences) {
        Event event;
        event.identity = identity(sequence, lossless);
        reorder.push(std::move(event), now);
    }
}

Sequences drain(Reorder& reorder)
{
    Sequences result;
    while (auto event = reorder.pop())
        result.push_back(event->identity.group.empty() ? event->identity.sequence : event->identity.turn);
    return result;
}

}  // namespace

TEST_CASE("reorder: results come out in the order of the captures")
{
    Reorder reorder(30s);
    push(reorder, {2, 1, 4, 3});
    CHECK(drain(reorder) == Sequences{1, 2, 3, 4});
}

TEST_CASE("reorder: a missing result holds up those after it until the patience is over")
{
    Reorder reorder(30s);
    push(reorder, {1, 3, 4});
    CHECK(drain(reorder) == Sequences{1});
    reorder.expire(start + 29s);
    CHECK(drain(reorder).empty());
    reorder.expire(start + 31s);
    CHECK(drain(reorder) == Sequences{3, 4});
    CHECK(reorder.missing() == 1);
}

TEST_CASE("reorder: a reported failure takes the place of its result")
{
    Reorder reorder(30s);
    push(reorder, {1, 3});
    reorder.fail(identity(2), start);
    CHECK(drain(reorder) == Sequences{1, 3});
    CHECK(reorder.failed() == 1);
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: a failure reported early is remembered until its turn")
{
    Reorder reorder(30s);
    push(reorder, {1});
    reorder.fail(identity(3), start);
    push(reorder, {4, 2});
    CHECK(drain(reorder) == Sequences{1, 2, 4});
}

TEST_CASE("reorder: live results wait a second at most, and 64 of them at most")
{
    Reorder reorder(30s);
    push(reorder, {10, 12}, false);
    CHECK(drain(reorder) == Sequences{10});
    reorder.expire(start + 1001ms);
    CHECK(drain(reorder) == Sequences{12});
    for (std::int64_t i = 14; i < 14 + 65; ++i)
        push(reorder, {i}, false, start + 2s);
    reorder.expire(start + 2s);
    CHECK(drain(reorder).size() == 65);
    CHECK(reorder.missing() == 2);
}

TEST_CASE("reorder: live results that nobody shares are not held up by what the source skipped")
{
    Reorder reorder(30s);
    for (const auto sequence : {5, 9, 14}) {
        Event event;
        event.identity = {.source = "camera", .epoch = 1, .sequence = sequence};
        reorder.push(std::move(event), start);
    }
    CHECK(drain(reorder) == Sequences{5, 9, 14});
}

TEST_CASE("reorder: a collector that comes late begins with what comes first")
{
    Reorder reorder(30s);
    push(reorder, {1001});
    push(reorder, {1000});
    CHECK(drain(reorder).empty());
    reorder.expire(start + 2001ms);
    CHECK(drain(reorder) == Sequences{1000, 1001});
    CHECK(reorder.missing() == 0);
}

TEST_CASE("reorder: what comes too late for its place is left out, and was counted")
{
    Reorder reorder(30s);
    push(reorder, {10, 12, 15}, false);
    reorder.expire(start + 1001ms);
    reorder.expire(start + 2002ms);
    CHECK(drain(reorder) == Sequences{10, 12, 15});
    CHECK(reorder.missing() == 3);
    push(reorder, {11, 13, 9, 16, 14}, false, start + 3s);
    CHECK(drain(reorder) == Sequences{16});
    CHECK(reorder.missing() == 3);
}

TEST_CASE("reorder: two outputs of one capture both come, also when they had to wait")
{
    Reorder reorder(30s);
    push(reorder, {1, 3, 3});
    CHECK(drain(reorder) == Sequences{1});
    push(reorder, {2});
    CHECK(drain(reorder) == Sequences{2, 3, 3});
}

TEST_CASE("reorder: at the beginning earlier results are waited for a short while")
{
    Reorder reorder(30s);
    push(reorder, {3});
    CHECK(drain(reorder).empty());
    push(reorder, {1});
    CHECK(drain(reorder) == Sequences{1});
    Reorder other(30s);
    push(other, {11});
    other.expire(start + 2001ms);
    CHECK(drain(other) == Sequences{11});
    CHECK(other.missing() == 0);
}

TEST_CASE("reorder: sources and their epochs are apart")
{
    Reorder reorder(30s);
    push(reorder, {1, 2});
    Event restarted;
    restarted.identity = identity(1, true, 2);
    reorder.push(std::move(restarted), start);
    CHECK(drain(reorder) == Sequences{1, 2, 1});
}

TEST_CASE("reorder: further parts of a result follow as they come")
{
    Reorder reorder(30s);
    push(reorder, {1, 2});
    Event part;
    part.identity = identity(2);
    part.identity.part = 1;
    reorder.push(std::move(part), start);
    CHECK(drain(reorder) == Sequences{1, 2, 2});
}

}  // namespace hive
