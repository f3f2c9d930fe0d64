// Second answers to shared work are refused.
#include <hive/event/sequence_filter.hpp>

#include <doctest/doctest.h>

namespace hive::event {
namespace {

Event answer(std::int64_t sequence, int attempt, const char* output = "faces", int part = 0)
{
    Event event;
    event.identity = {
        .source = "camera", .epoch = 1, .sequence = sequence, .attempt = attempt, .part = part, .hops = {}};
    event.kind = "face";
    event.output = output;
    return event;
}

}  // namespace

TEST_CASE("sequence filter: the answer of another attempt at the same event is refused")
{
    SequenceFilter filter;
    CHECK(filter.first(answer(1, 1)));
    CHECK_FALSE(filter.first(answer(1, 2)));
    CHECK(filter.first(answer(2, 2)));
}

TEST_CASE("sequence filter: other outputs, parts and epochs are other answers")
{
    SequenceFilter filter;
    CHECK(filter.first(answer(1, 1)));
    CHECK(filter.first(answer(1, 1, "annotated")));
    CHECK(filter.first(answer(1, 1, "faces", 1)));
    auto later = answer(1, 1);
    later.identity.epoch = 2;
    CHECK(filter.first(later));
}

TEST_CASE("sequence filter: an identity that a replay gives again is another job, in a turn of its own")
{
    SequenceFilter filter;
    auto job = answer(1, 1);
    job.identity.group = "workers";
    job.identity.turn = 1;
    CHECK(filter.first(job));
    job.identity.turn = 11;
    CHECK(filter.first(job));
    job.identity.attempt = 2;
    CHECK_FALSE(filter.first(job));
}

TEST_CASE("sequence filter: events that nobody shares pass as often as they come")
{
    SequenceFilter filter;
    CHECK(filter.first(answer(1, 0)));
    CHECK(filter.first(answer(1, 0)));
}

TEST_CASE("sequence filter: its memory is bounded")
{
    SequenceFilter filter;
    for (std::int64_t i = 1; i <= static_cast<std::int64_t>(SequenceFilter::remembered) + 1; ++i)
        filter.first(answer(i, 1));
    CHECK(filter.first(answer(1, 1)));
    CHECK_FALSE(filter.first(answer(SequenceFilter::remembered, 1)));
}

}  // namespace hive::event
