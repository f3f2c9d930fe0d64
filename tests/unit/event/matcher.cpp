// Events of several inputs brought together by identity: with gaps, restarts, duplicates and workers.
#include "matcher_fixtures.hpp"

namespace hive::event {

using namespace matching;

TEST_CASE("matcher: events of one capture make a set, whichever comes first, in the order of the inputs")
{
    Case c;
    CHECK(c.give("image", {1}).empty());
    CHECK(c.give("marks", {1}) == Sets{{1, 1}});
    CHECK(c.give("marks", {2}).empty());
    CHECK(c.give("image", {2}) == Sets{{2, 2}});
    CHECK(c.matcher.counts().sets == 2);
    CHECK(c.waiting() == 0);
    CHECK(c.matcher.counts().unmatched == 0);
}

TEST_CASE("matcher: a slow detector's boxes find their pictures among those that came since, and what it left out is "
          "counted as missing marks")
{
    Case c;
    c.give("image", {1, 2, 3, 4});
    CHECK(c.give("marks", {1}) == Sets{{1, 1}});
    c.give("image", {5, 6, 7});
    CHECK(c.give("marks", {5}) == Sets{{5, 5}});
    CHECK(c.missing("marks") == 3);
    CHECK(c.missing("image") == 0);
    CHECK(c.waiting() == 2);
}

TEST_CASE(
    "matcher: marks of a picture that this end never got are counted as missing image when a later picture has come")
{
    Case c;
    c.give("image", {1});
    c.give("marks", {2});
    CHECK(c.missing("image") == 0);
    c.give("image", {3});
    CHECK(c.missing("image") == 1);
    CHECK(c.give("marks", {3}) == Sets{{3, 3}});
    CHECK(c.missing("marks") == 1);
    c.give("marks", {2});
    CHECK(c.missing("image") == 2);
    CHECK(c.waiting() == 0);
}

TEST_CASE("matcher: a source that restarted counts from 1 again, and what waits of its life before goes")
{
    Case c;
    c.give("image", {8, 9});
    CHECK(c.give("marks", {8}) == Sets{{8, 8}});
    c.give("image", {1, 2}, {.epoch = 2});
    CHECK(c.give("marks", {1}, {.epoch = 2}) == Sets{{1, 1}});
    CHECK(c.missing("marks") == 1);
    CHECK(c.give("marks", {9}).empty());
    CHECK(c.missing("image") == 1);
    CHECK(c.give("marks", {2}, {.epoch = 2}) == Sets{{2, 2}});
}

TEST_CASE("matcher: a source may restart after its clock was set back, and several times before an input hears of it")
{
    Case c;
    c.give("image", {8, 9}, {.epoch = 5});
    CHECK(c.give("marks", {8}, {.epoch = 5}) == Sets{{8, 8}});
    c.give("image", {1, 2}, {.epoch = 2});
    CHECK(c.missing("marks") == 0);
    CHECK(c.give("marks", {9}, {.epoch = 5}) == Sets{{9, 9}});
    c.give("image", {1}, {.epoch = 4});
    c.give("image", {1}, {.epoch = 1});
    CHECK(c.give("marks", {1}, {.epoch = 2}) == Sets{{1, 1}});
    CHECK(c.give("marks", {1}, {.epoch = 4}) == Sets{{1, 1}});
    CHECK(c.missing("marks") == 1);  // number 2 of the run before
    CHECK(c.give("marks", {1}, {.epoch = 1}) == Sets{{1, 1}});
    CHECK(c.waiting() == 0);
}

TEST_CASE("matcher: a source that restarts after its clock was set back may have been silent for long")
{
    Case c;
    c.give("image", {8, 9}, {.epoch = 5});
    CHECK(c.give("marks", {8}, {.epoch = 5}) == Sets{{8, 8}});
    c.pass(2 * Matcher::timeout);
    CHECK(c.give("image", {1}, {.epoch = 2}).empty());
    CHECK(c.give("marks", {1}, {.epoch = 2}) == Sets{{1, 1}});
    CHECK(c.missing("marks") == 1);
}

TEST_CASE("matcher: of more sources than are remembered each has its runs ordered by epoch")
{
    Case c;
    for (int i = 0; i < 2 * static_cast<int>(Runs::most_sources); ++i) {
        const auto source = "source-" + std::to_string(1000 + i);
        c.give("image", {7}, {.source = source, .epoch = 5});
        CHECK(c.give("marks", {7}, {.source = source, .epoch = 5}) == Sets{{7, 7}});
    }
    c.give("image", {1}, {.source = "source-1000", .epoch = 6});
    CHECK(c.give("marks", {1}, {.source = "source-1000", .epoch = 6}) == Sets{{1, 1}});
    CHECK(c.matcher.counts().unmatched == 0);
}

TEST_CASE("matcher: other sources, epochs and parts are other captures")
{
    Case c;
    c.give("image", {1});
    CHECK(c.give("marks", {1}, {.epoch = 2}).empty());
    CHECK(c.give("marks", {1}, {.part = 1}).empty());
    auto other = event("marks", 1);
    other.identity.source = "another camera";
    c.matcher.push(std::move(other), c.now);
    CHECK(c.sets().empty());
    Case parts;
    parts.give("image", {1});
    parts.give("image", {1}, {.part = 1});
    CHECK(parts.give("marks", {1}) == Sets{{1, 1}});
    CHECK(parts.give("marks", {1}, {.part = 1}) == Sets{{1, 1}});
    CHECK(parts.waiting() == 0);
}

TEST_CASE("matcher: a second event of a capture at the same input is refused while the first waits")
{
    Case c;
    c.give("marks", {1});
    c.give("marks", {1}, {.sender = "another"});
    CHECK(c.matcher.counts().duplicates == 1);
    CHECK(c.give("image", {1}) == Sets{{1, 1}});
    CHECK(c.give("marks", {1}, {.sender = "another"}).empty());
    CHECK(c.missing("image") == 1);
    CHECK(c.matcher.counts().sets == 1);
}

TEST_CASE("matcher: workers that share a job keep no order, so a late answer still finds its picture, and its source "
          "is not held up for it")
{
    Case c;
    const Made one{.lossless = true, .sender = "face-1", .group = "faces"},
        two{.lossless = true, .sender = "face-2", .group = "faces"};
    c.give("image", {1, 2, 3, 4, 5, 6}, lossless);
    CHECK(c.give("marks", {2}, two) == Sets{{2, 2}});
    CHECK(c.give("marks", {4}, two) == Sets{{4, 4}});
    CHECK(c.held() == 0);
    CHECK(c.give("marks", {1}, one) == Sets{{1, 1}});
    CHECK(c.give("marks", {3}, two) == Sets{{3, 3}});
    CHECK(c.matcher.counts().unmatched == 0);
    CHECK(c.give("marks", {6, 5}, one) == Sets{{6, 6}, {5, 5}});
}

TEST_CASE("matcher: two senders of one input: what one has passed the other may still bring")
{
    Case c;
    c.give("image", {1, 2, 3, 4});
    c.give("marks", {1}, {.sender = "even"});
    c.give("marks", {3}, {.sender = "odd"});
    CHECK(c.missing("marks") == 0);
    CHECK(c.give("marks", {2}, {.sender = "even"}) == Sets{{2, 2}});
    CHECK(c.give("marks", {4}, {.sender = "even"}) == Sets{{4, 4}});
}

TEST_CASE("matcher: a sender that has gone stops nobody from passing")
{
    Case c;
    c.give("image", {1});
    c.give("marks", {1}, {.sender = "gone"});
    c.pass(3s);
    c.give("image", {2, 3});
    c.give("marks", {2}, {.sender = "here"});
    c.pass(2s);
    c.give("image", {4, 5});
    CHECK(c.give("marks", {5}, {.sender = "here"}).size() == 1);
    CHECK(c.missing("marks") == 2);
    CHECK(c.waiting() == 0);
}

TEST_CASE("matcher: three inputs make sets of three, and the one that is missing is named")
{
    Case c(Match::exact(), {"image", "faces", "hands"});
    c.give("image", {1, 2});
    c.give("hands", {1});
    CHECK(c.give("faces", {1, 2}) == Sets{{1, 1, 1}});
    CHECK(c.give("hands", {3}).empty());
    CHECK(c.missing("hands") == 2);  // of the picture and of the faces
    CHECK(c.missing("image") == 0);
    CHECK(c.missing("faces") == 0);
    c.give("image", {3});
    CHECK(c.give("faces", {3}) == Sets{{3, 3, 3}});
}

TEST_CASE("sets: what comes of one has the identity of its first event, and each drone on the way once")
{
    std::vector<Event> set{event("image", 5), event("marks", 5)};
    set[0].identity.hops = {{"resize", 1, 2}};
    set[1].identity.hops = {{"resize", 1, 2}, {"face", 3, 4}};
    set[1].identity.shares = {{.of = "camera.image#faces", .epoch = 1, .turn = 5}};
    const auto identity = identity_of(set);
    CHECK(identity.sequence == 5);
    CHECK(identity.shares.empty());
    REQUIRE(identity.hops.size() == 2);
    CHECK(identity.hops[0].drone == "resize");
    CHECK(identity.hops[1].drone == "face");
}

TEST_CASE("sets: no event is acknowledged until what was made of all is dealt with, and none is processed any more")
{
    std::vector<Event> set{event("image", 5), event("marks", 5)};
    const std::weak_ptr<Acknowledgement> first = set[0].ticket.owed(), second = set[1].ticket.owed();
    auto both = causes(set);
    CHECK(is_processing(first));
    set.clear();
    CHECK_FALSE(is_processing(first));
    CHECK_FALSE(first.expired());
    CHECK_FALSE(second.expired());
    both = {};
    CHECK(first.expired());
    CHECK(second.expired());
}

TEST_CASE("sets: what is made of one event has its ticket, and what nobody must acknowledge has none")
{
    std::vector<Event> set{event("image", 5)};
    CHECK(causes(set).owed() == set[0].ticket.owed());
    CHECK_FALSE(causes(set).processing());
    set.push_back(event("marks", 5));
    set[0].ticket = set[1].ticket = {};
    CHECK_FALSE(causes(set).owed());
}

}  // namespace hive::event
