// How long events wait for their partners, and which of them hold up their source.
#include "matcher_fixtures.hpp"

namespace hive::event {

using namespace matching;

TEST_CASE("matcher: live events are not processed while they wait, the one that completes a set is")
{
    Case c;
    c.give("image", {1, 2, 3});
    CHECK(c.held() == 0);
    auto marks = event("marks", 2);
    const std::weak_ptr<Acknowledgement> ticket = marks.ticket.owed();
    c.matcher.push(std::move(marks), c.now);
    auto set = c.matcher.pop();
    REQUIRE(set);
    CHECK(is_processing(ticket));
    for (const auto& each : *set)
        CHECK(each.ticket.owed());  // also of those that had to wait: the set is not dealt with yet
    set.reset();
    CHECK(ticket.expired());
}

TEST_CASE("matcher: live events wait at most 4 s, at most 128 of them, and at most 128 MiB")
{
    Case old;
    old.give("image", {1});
    CHECK(old.matcher.deadline() == start + Matcher::timeout);
    old.pass(3999ms);
    CHECK(old.waiting() == 1);
    old.pass(1ms);
    CHECK(old.waiting() == 0);
    CHECK(old.missing("marks") == 1);
    CHECK_FALSE(old.matcher.deadline());

    Case many;
    for (std::int64_t i = 1; i <= 130; ++i)
        many.give("image", {i});
    CHECK(many.waiting() == 128);
    CHECK(many.missing("marks") == 2);
    CHECK(many.give("marks", {2}).empty());
    CHECK(many.give("marks", {3}) == Sets{{3, 3}});

    Case large;
    for (std::int64_t i = 1; i <= 5; ++i)
        large.give("image", {i}, {.bytes = 32u << 20});
    CHECK(large.waiting() == 4);
    CHECK(large.missing("marks") == 1);
    CHECK(large.give("marks", {2}) == Sets{{2, 2}});
}

TEST_CASE("matcher: one event larger than all that may wait still waits")
{
    Case c;
    c.give("image", {1}, {.bytes = WaitingLine::most_live_bytes + 1});
    CHECK(c.give("marks", {1}) == Sets{{1, 1}});
}

TEST_CASE("matcher: of lossless events four may wait before their source is held up, and it goes on as they find their "
          "partners")
{
    Case c;
    c.give("image", {1, 2, 3, 4}, lossless);
    CHECK(c.held() == 0);
    c.give("image", {5, 6}, lossless);
    CHECK(c.held() == 2);
    CHECK(c.give("marks", {1}, lossless) == Sets{{1, 1}});
    CHECK(c.held() == 1);
    CHECK(c.give("marks", {2}, lossless) == Sets{{2, 2}});
    CHECK(c.held() == 0);
    CHECK(c.matcher.counts().unmatched == 0);
}

TEST_CASE("matcher: lossless events never go for their age; those whose partner was left out go when a later one came")
{
    Case c;
    for (std::int64_t i = 1; i <= 300; ++i)
        c.give("image", {i}, lossless);
    c.pass(60s);
    CHECK(c.waiting() == 300);
    CHECK(c.give("marks", {3}, lossless) == Sets{{3, 3}});
    CHECK(c.missing("marks") == 2);
    CHECK(c.give("marks", {300}, lossless) == Sets{{300, 300}});
    CHECK(c.missing("marks") == 298);
    CHECK(c.waiting() == 0);
}

TEST_CASE("matcher: an input from which nothing comes for 4 s holds up no source any more, until something comes again")
{
    Case c;
    c.give("image", {1, 2, 3, 4, 5}, lossless);
    CHECK(c.held() == 1);
    c.pass(3999ms);
    CHECK(c.held() == 1);
    c.pass(1ms);
    CHECK(c.held() == 0);
    CHECK_FALSE(c.matcher.deadline());
    c.give("image", {6}, lossless);
    CHECK(c.held() == 0);
    c.give("marks", {1}, lossless);
    c.give("image", {7}, lossless);
    CHECK(c.held() == 1);
    CHECK(c.matcher.deadline());
}

TEST_CASE("matcher: while something comes, a held event is looked at again and does not spin")
{
    Case c;
    c.give("image", {1, 2, 3, 4, 5}, lossless);
    c.pass(3s);
    c.give("marks", {1}, lossless);
    c.give("image", {6, 7}, lossless);
    CHECK(c.held() == 2);
    c.pass(3s);
    c.give("marks", {2}, lossless);
    CHECK(c.held() == 1);
    c.pass(1s);  // now it has waited for 4 s, but its partner's input is alive
    CHECK(c.held() == 1);
    REQUIRE(c.matcher.deadline());
    CHECK(*c.matcher.deadline() > c.now);
    c.pass(3s);
    CHECK(c.held() == 0);
}

}  // namespace hive::event
