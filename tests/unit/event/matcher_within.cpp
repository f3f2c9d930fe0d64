// Events of several inputs brought together by the time of their captures.
#include "matcher_fixtures.hpp"

namespace hive::event {

using namespace matching;

TEST_CASE(
    "matcher: within a time each event of the slower input gets the nearest of the other, when no nearer one can come")
{
    Case c(Match::within(50ms));
    c.give("image", {1}, {.captured_us = 0});
    c.give("image", {2}, {.captured_us = 33'000});
    CHECK(c.give("marks", {1}, {.captured_us = 60'000}).empty());  // 66 ms would be nearer
    CHECK(c.give("image", {3}, {.captured_us = 66'000}).empty());  // and to that, marks of 70 ms would be nearer
    CHECK(c.give("marks", {2}, {.captured_us = 260'000}) == Sets{{3, 1}});
    CHECK(c.missing("marks") == 2);
    c.give("image", {9}, {.captured_us = 311'000});
    CHECK(c.missing("image") == 1);
}

TEST_CASE("matcher: within a time captures of the same moment are a set at once, and the sources may differ")
{
    Case c(Match::within(0ms));
    c.give("image", {1}, {.captured_us = 5'000});
    auto other = event("marks", 77, {.captured_us = 5'000});
    other.identity.source = "another camera";
    c.matcher.push(std::move(other), c.now);
    CHECK(c.sets() == Sets{{1, 77}});
}

TEST_CASE("matcher: within a time the tolerance is inclusive, and beyond it there is no partner")
{
    Case c(Match::within(20ms));
    c.give("image", {1}, {.captured_us = 100'000});
    c.give("marks", {1}, {.captured_us = 120'000});
    CHECK(c.give("image", {2}, {.captured_us = 200'000}) == Sets{{1, 1}});
    c.give("marks", {2}, {.captured_us = 220'001});
    CHECK(c.give("image", {3}, {.captured_us = 300'000}).empty());
    CHECK(c.missing("marks") == 1);
    CHECK(c.missing("image") == 1);
}

TEST_CASE("matcher: within a time a pair that nothing more comes for is made when it has waited long enough")
{
    Case c(Match::within(50ms));
    c.give("image", {1}, {.captured_us = 0});
    c.give("marks", {1}, {.captured_us = 10'000});
    CHECK(c.sets().empty());
    c.pass(4s);
    CHECK(c.sets() == Sets{{1, 1}});
    CHECK(c.matcher.counts().unmatched == 0);
}

TEST_CASE(
    "matcher: within a time two sources on demand go in step: the one that is ahead is held up, the one behind is not")
{
    Case c(Match::within(1ms));
    for (std::int64_t i = 1; i <= 6; ++i)
        c.give("image", {i}, {.lossless = true});
    CHECK(c.held() == 2);
    CHECK(c.give("marks", {1}, {.lossless = true}) == Sets{{1, 1}});
    CHECK(c.held() == 1);
    Case behind(Match::within(1s));
    behind.give("marks", {100}, lossless);
    for (std::int64_t i = 1; i <= 20; ++i)
        behind.give("image", {i}, lossless);
    CHECK(behind.held() == 0);
}

TEST_CASE("matcher: the rule may change while events wait")
{
    Case c;
    c.give("image", {1}, {.captured_us = 0});
    auto other = event("marks", 2, {.captured_us = 30});
    other.identity.source = "another camera";
    c.matcher.push(std::move(other), c.now);
    CHECK(c.sets().empty());
    c.matcher.rule(Match::within(1ms));
    CHECK(c.give("image", {3}, {.captured_us = 33'000}) == Sets{{1, 2}});
    CHECK(c.give("marks", {4}, {.captured_us = 33'000}) == Sets{{3, 4}});
}

TEST_CASE("matcher: fewer than two inputs are refused, and so is an event of another input")
{
    CHECK_THROWS_AS(Matcher({"image"}, Match::exact()), Error);
    Case c;
    CHECK_THROWS_AS(c.matcher.push(event("sound", 1), start), Error);
}

TEST_CASE("matcher: when nothing more will come, the last pair is made at once and the rest is given up")
{
    Case c(Match::within(50ms));
    c.give("image", {1}, {.lossless = true, .captured_us = 0});
    c.give("marks", {1}, {.lossless = true, .captured_us = 10'000});
    c.give("marks", {2}, {.lossless = true, .captured_us = 500'000});
    CHECK(c.sets().empty());
    c.matcher.finish();
    CHECK(c.matcher.ready());
    CHECK(c.sets() == Sets{{1, 1}});
    CHECK(c.missing("image") == 1);
    CHECK(c.waiting() == 0);
    CHECK(c.held() == 0);
}

TEST_CASE("matcher: after a pause the time of workers that share may begin lower, if the clock was set back")
{
    Case c(Match::within(5ms));
    const auto at = [](std::int64_t captured_us, const std::string& group) {
        return Made{.group = group, .captured_us = captured_us};
    };
    c.give("image", {1}, at(1'000'000, ""));
    c.give("marks", {1}, at(1'000'000, "workers"));
    c.give("image", {2}, at(1'010'000, ""));
    const auto before = c.matcher.counts().sets;
    c.pass(2 * Matcher::timeout);
    c.give("marks", {1}, at(10'000, "workers"));
    c.give("image", {1}, at(10'000, ""));
    c.give("image", {2}, at(20'000, ""));
    c.give("marks", {2}, at(20'000, "workers"));
    c.give("image", {3}, at(30'000, ""));
    c.give("marks", {3}, at(30'000, "workers"));
    CHECK(c.matcher.counts().sets >= before + 2);
}

}  // namespace hive::event
