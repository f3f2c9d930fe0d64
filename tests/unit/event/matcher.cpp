// Events of several inputs brought together: by identity, by time, with gaps, restarts, workers, and with the pace of their sources.
#include <hive/event/matcher.hpp>

#include <hive/error.hpp>

#include <doctest/doctest.h>

#include <algorithm>

namespace hive::event {
namespace {

using namespace std::chrono_literals;
using Sequences = std::vector<std::int64_t>;

const Matcher::TimePoint start{};

/// What an event is made of, beside its sequence: a live one of the camera, unless it says otherwise.
struct Made {
    bool lossless = false;
    std::int64_t epoch = 1;
    int part = 0;
    std::string sender = {};
    std::string group = {};
    std::size_t bytes = 10;
    std::int64_t captured_us = -1;  ///< -1: 10 ms after the one before
};

Event event(const std::string& input, std::int64_t sequence, const Made& made = {})
{
    Event event;
    event.identity = {.source = "camera", .epoch = made.epoch, .sequence = sequence, .captured_us = made.captured_us < 0 ? 10'000 * sequence : made.captured_us,
                      .lossless = made.lossless, .group = made.group, .part = made.part, .hops = {}};
    event.sender = made.sender.empty() ? "sender of " + input : made.sender;
    event.output = "out";
    event.input = input;
    event.body = Body(std::vector<unsigned char>(made.bytes, 7));
    event.receipt = std::make_shared<int>(0);
    return event;
}

/// A matcher that is told the time by the tests, and remembers which receipts are still held.
class Case {
public:
    explicit Case(Match match = Match::exact(), const std::vector<std::string>& inputs = {"image", "marks"}) : matcher(inputs, match) {}

    /// Gives events to an input; returns what the sets that became complete are made of.
    std::vector<Sequences> give(const std::string& input, std::initializer_list<std::int64_t> sequences, const Made& made = {})
    {
        for (const auto sequence : sequences) {
            auto fresh = event(input, sequence, made);
            receipts.emplace_back(fresh.receipt);
            matcher.push(std::move(fresh), now);
        }
        return sets();
    }
    std::vector<Sequences> sets()
    {
        std::vector<Sequences> result;
        while (const auto set = matcher.pop()) {
            result.emplace_back();
            for (const auto& each : *set)
                result.back().push_back(each.identity.sequence);
        }
        return result;
    }
    void pass(std::chrono::milliseconds time)
    {
        now += time;
        matcher.expire(now);
    }
    [[nodiscard]] std::int64_t missing(const std::string& input) const
    {
        const auto counts = matcher.counts();
        return counts.missing.contains(input) ? counts.missing.at(input) : 0;
    }
    [[nodiscard]] std::int64_t waiting() const { return matcher.counts().waiting; }
    [[nodiscard]] std::ptrdiff_t held() const
    {
        return std::ranges::count_if(receipts, [](const auto& receipt) { return !receipt.expired(); });
    }

    Matcher matcher;
    Matcher::TimePoint now = start;
    std::vector<std::weak_ptr<const void>> receipts;
};

using Sets = std::vector<Sequences>;
const Made lossless{.lossless = true};

}  // namespace

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

TEST_CASE("matcher: a slow detector's boxes find their pictures among those that came since, and what it left out is counted as missing marks")
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

TEST_CASE("matcher: marks of a picture that this end never got are counted as missing image when a later picture has come")
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

TEST_CASE("matcher: live events give back their receipts when they have to wait, the one that completes a set keeps its own")
{
    Case c;
    c.give("image", {1, 2, 3});
    CHECK(c.held() == 0);
    auto marks = event("marks", 2);
    const std::weak_ptr<const void> receipt = marks.receipt;
    c.matcher.push(std::move(marks), c.now);
    auto set = c.matcher.pop();
    REQUIRE(set);
    CHECK_FALSE(receipt.expired());
    CHECK(receipt_of(*set) == receipt.lock());
    set.reset();
    CHECK(receipt.expired());
}

TEST_CASE("matcher: live events wait at most 4 s, at most 128 of them, and at most 128 MiB")
{
    Case old;
    old.give("image", {1});
    CHECK(old.matcher.deadline() == start + Matcher::patience);
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

TEST_CASE("matcher: of lossless events four may wait before their source is held up, and it goes on as they find their partners")
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

TEST_CASE("matcher: workers that share a job keep no order, so a late answer still finds its picture, and its source is not held up for it")
{
    Case c;
    const Made one{.lossless = true, .sender = "face-1", .group = "faces"}, two{.lossless = true, .sender = "face-2", .group = "faces"};
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

TEST_CASE("matcher: within a time each event of the slower input gets the nearest of the other, when no nearer one can come")
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

TEST_CASE("matcher: within a time two sources on demand go in step: the one that is ahead is held up, the one behind is not")
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

TEST_CASE("sets: what comes of one has the identity of its first event, and each drone on the way once")
{
    std::vector<Event> set{event("image", 5), event("marks", 5)};
    set[0].identity.hops = {{"resize", 1, 2}};
    set[1].identity.hops = {{"resize", 1, 2}, {"face", 3, 4}};
    set[1].identity.group = "faces";
    const auto identity = identity_of(set);
    CHECK(identity.sequence == 5);
    CHECK(identity.group.empty());
    REQUIRE(identity.hops.size() == 2);
    CHECK(identity.hops[0].drone == "resize");
    CHECK(identity.hops[1].drone == "face");
}

TEST_CASE("sets: the receipts of all are held together")
{
    std::vector<Event> set{event("image", 5), event("marks", 5)};
    const std::weak_ptr<const void> first = set[0].receipt, second = set[1].receipt;
    auto both = receipt_of(set);
    set.clear();
    CHECK_FALSE(first.expired());
    CHECK_FALSE(second.expired());
    both.reset();
    CHECK(first.expired());
    CHECK(second.expired());
}

}  // namespace hive::event
