// What an input that registers again lets its sender give: no more than it has room for.
#include "fixtures.hpp"

#include <hive/event/credit.hpp>
#include <hive/event/input_progress.hpp>

#include <doctest/doctest.h>

namespace hive::event {
namespace {

/// An input that has got all that it may have, and has processed nothing, at a sender that is restarted then.
InputProgress full_at_restarted_sender(const ConnectionOptions& options, std::int64_t events)
{
    InputProgress input;
    CHECK_FALSE(input.begin(1, options, 5, 0, input.held(true)));
    for (std::int64_t i = 0; i < events; ++i) {
        CHECK(input.allows(true));
        input.receive(true, 0);
    }
    CHECK_FALSE(input.allows(true));
    input.lose_place();
    CHECK(input.held(true) == events);
    CHECK_FALSE(input.begin(2, options, 6, 0, input.held(true)));
    return input;
}

}  // namespace

TEST_CASE("input progress: a full stream takes nothing from a new run of its sender before it has processed all")
{
    auto input = full_at_restarted_sender(streaming(), Credit::most_streamed);
    CHECK_FALSE(input.allows(true));
    CHECK_FALSE(input.news(false));
    for (std::int64_t number = 1; number <= Credit::most_streamed; ++number) {
        CHECK_FALSE(input.news(true));
        input.heard(1, number, true, true, false);
    }
    CHECK_FALSE(input.news(false));  // it has halted
    const auto news = input.news(true);
    REQUIRE(news);
    CHECK(news->worked == 0);
    CHECK(input.allows(true));
    CHECK(input.held(true) == 0);
}

TEST_CASE("input progress: what came from an earlier run of the sender is still to be worked on")
{
    auto input = full_at_restarted_sender(window(2), 2);
    CHECK(input.all_worked());
    CHECK(input.works());
    input.heard(1, 1, true, true, false);
    CHECK(input.works());
    input.heard(1, 2, true, true, false);
    CHECK_FALSE(input.works());
}

TEST_CASE("input progress: a full window takes one from a new run of its sender for each that it has processed")
{
    auto input = full_at_restarted_sender(window(2), 2);
    CHECK_FALSE(input.allows(true));
    CHECK_FALSE(input.news(true));
    input.heard(1, 1, true, false, false);
    CHECK_FALSE(input.news(false));
    const auto news = input.news(true);
    REQUIRE(news);
    CHECK(news->id == 1);
    CHECK(input.allows(true));
    input.receive(true, 0);
    CHECK_FALSE(input.allows(true));
    input.heard(1, 1, false, true, false);  // its end makes no further room
    CHECK_FALSE(input.news(true));
}

TEST_CASE("input progress: at the same place it asks only for what it has processed, too")
{
    InputProgress input;
    CHECK_FALSE(input.begin(1, window(3), 5, 0, 0));
    for (int i = 0; i < 3; ++i)
        input.receive(true, 0);
    input.heard(input.generation(), 1, true, false, false);
    CHECK(input.held(true) == 2);
    CHECK(input.begin(2, window(3), 5, 3, 2));
    CHECK(input.allows(true));
    input.receive(true, 0);
    CHECK_FALSE(input.allows(true));
    CHECK_FALSE(input.news(true));
    input.heard(input.generation(), 2, true, false, false);
    const auto news = input.news(true);
    REQUIRE(news);
    CHECK(news->id == 5);
}

TEST_CASE("input progress: what an earlier input of the same ends has not processed takes room, too")
{
    for (const auto& options : {window(2), streaming()}) {
        InputProgress input;
        const auto window = options.transfer == Transfer::streaming ? Credit::most_streamed : options.window;
        CHECK_FALSE(input.begin(1, options, 5, 0, window));
        CHECK_FALSE(input.allows(true));
        CHECK_FALSE(input.news(true, false, window));
        REQUIRE(input.news(true, false, 0));
        for (std::int64_t i = 0; i < window; ++i) {
            CHECK(input.allows(true));
            input.receive(true, 0);
        }
        CHECK_FALSE(input.allows(true));
    }
}

TEST_CASE("input progress: while it may not ask, what it has processed and not acknowledged takes room, too")
{
    auto input = full_at_restarted_sender(streaming(), Credit::most_streamed);
    for (std::int64_t number = 1; number <= Credit::most_streamed; ++number)
        input.heard(1, number, true, false, false);
    CHECK(input.held(true) == 0);
    CHECK(input.held(false) == Credit::most_streamed);
    CHECK_FALSE(input.begin(3, streaming(), 7, 0, input.held(false)));
    CHECK_FALSE(input.allows(true));
    CHECK_FALSE(input.news(false));
    input.heard(1, 1, false, true, false);
    CHECK(input.held(false) == Credit::most_streamed - 1);
    CHECK(input.news(true));
    CHECK(input.allows(true));
}

TEST_CASE("input progress: a halted receiver reports the end of an event at once, since the next may take long")
{
    InputProgress input;
    CHECK_FALSE(input.begin(1, window(3), 5, 0, 0));
    for (int i = 0; i < 3; ++i)
        input.receive(false, 0);
    input.heard(input.generation(), 1, true, false, false);
    CHECK(input.news(true));
    CHECK_FALSE(input.news(false));
    input.heard(input.generation(), 1, false, true, false);
    CHECK_FALSE(input.news(true));  // it goes with the next
    const auto news = input.news(false);
    REQUIRE(news);
    CHECK(news->done == 1);
    CHECK_FALSE(input.news(false));
}

TEST_CASE("input progress: a stream reports live events late, or after 16 of them, and lossless ones at once")
{
    InputProgress input;
    CHECK_FALSE(input.begin(1, streaming(), 5, 0, 0));
    const auto process = [&](bool lossless) {
        input.heard(input.generation(), input.receive(lossless, 0), true, true, false);
        return input.news(true);
    };
    CHECK(process(false));  // the first shows the sender that it is here
    for (int i = 0; i < 15; ++i) {
        CHECK_FALSE(process(false));
        CHECK(input.has_late_news());
    }
    const auto sixteenth = process(false);
    REQUIRE(sixteenth);
    CHECK(sixteenth->done == 17);
    CHECK_FALSE(input.has_late_news());

    CHECK_FALSE(process(false));
    const auto late = input.news(true, true);
    REQUIRE(late);
    CHECK(late->done == 18);
    CHECK_FALSE(input.news(true, true));

    CHECK(process(true));
    CHECK_FALSE(process(false));
    CHECK(input.has_late_news());
    const auto results_wait = input.receive(true, 0);
    const auto before_it = input.news(true);
    REQUIRE(before_it);
    CHECK(before_it->worked == 20);
    input.heard(input.generation(), results_wait, true, false, false);
    const auto processed = input.news(true);
    REQUIRE(processed);
    CHECK(processed->worked == 21);
    CHECK(processed->done == 20);
    input.heard(input.generation(), results_wait, false, true, false);
    CHECK(input.news(true));
}

TEST_CASE("input progress: a member repeats what it returned over a connection that was lost, unless that got there")
{
    InputProgress input;
    CHECK_FALSE(input.begin(1, sharing(2), 5, 0, 0));
    for (int i = 0; i < 2; ++i)
        input.receive(true, 1 + i);
    input.heard(input.generation(), 1, true, true, true);
    const auto first = input.news(true);
    REQUIRE(first);
    CHECK(first->back == std::vector<std::int64_t>{1});
    CHECK(first->done == 1);
    bool arrived = false;
    SUBCASE("it may be lost") {}
    SUBCASE("the next delivery shows that it is not")
    {
        arrived = true;
        input.receive(true, 3);
    }
    CHECK(input.place() == 5);
    CHECK(input.begin(2, sharing(2), 5, input.arrived(), input.held(true)));
    const auto repeated = input.news(true);
    REQUIRE(repeated);
    CHECK(repeated->back.empty() == arrived);
    CHECK(repeated->done == 1);
    CHECK_FALSE(input.news(true));
}

TEST_CASE("input progress: a member that has more to return than a request can hold has no place")
{
    InputProgress input;
    CHECK_FALSE(input.begin(1, sharing(64), 5, 0, 0));
    for (int i = 0; i < 64; ++i)
        input.receive(true, 1 + i);
    for (int i = 0; i < 64; ++i)
        input.heard(input.generation(), 1 + i, true, true, true);
    CHECK(input.news(false));
    CHECK(input.place() == 5);
    CHECK(input.begin(2, sharing(64), 5, 64, 0));
    CHECK(input.news(false));
    input.receive(true, 65);
    CHECK(input.place() == 0);
}

}  // namespace hive::event
