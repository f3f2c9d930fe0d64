// An event that comes again is refused, and so are second answers to work that was given out twice.
#include <hive/event/answer_filter.hpp>

#include <doctest/doctest.h>

namespace hive::event {
namespace {

const Share turn_1{.of = "camera.image#workers", .epoch = 1, .turn = 1, .attempt = 1, .to = "image"};

Share with(Share share, std::int64_t turn, int attempt)
{
    share.turn = turn;
    share.attempt = attempt;
    return share;
}

/// What the drone `sender`, a face detector, made of the work that the shares name.
Event answer(std::vector<Share> shares, const std::string& sender = "face-1", const char* output = "faces",
             int part = 0)
{
    Event event;
    event.identity = {.source = "camera", .epoch = 1, .sequence = 1, .part = part, .shares = std::move(shares)};
    event.sender = sender;
    event.kind = "face";
    event.output = output;
    return event;
}

/// By which the sender of the answer itself gave it out.
Share own(const std::string& of, int attempt = 1) { return {.of = of, .epoch = 9, .turn = 1, .attempt = attempt}; }

}  // namespace

TEST_CASE("answer filter: the answer of another attempt at the same work is refused")
{
    AnswerFilter filter;
    CHECK(filter.first(answer({turn_1})));
    CHECK_FALSE(filter.first(answer({with(turn_1, 1, 2)}, "face-2")));
    CHECK(filter.first(answer({with(turn_1, 2, 2)}, "face-2")));
    CHECK_FALSE(filter.first(answer({with(turn_1, 2, 1)})));
}

TEST_CASE(
    "answer filter: an attempt is answered once, by one drone; a second event of an answer has a number of its own")
{
    AnswerFilter filter;
    CHECK(filter.first(answer({turn_1})));
    CHECK(filter.first(answer({turn_1}, "face-1", "faces", 1)));
    CHECK_FALSE(filter.first(answer({turn_1})));
    CHECK_FALSE(filter.first(answer({turn_1}, "face-1", "faces", 1)));
    CHECK_FALSE(filter.first(answer({turn_1}, "liar")));
}

TEST_CASE("answer filter: a plain receiver that was replaced by a drone of another kind is the same receiver")
{
    AnswerFilter filter;
    const Share plain{.of = "camera.image", .epoch = 1, .turn = 1, .to = "image"};
    CHECK(filter.first(answer({plain}, "finder")));
    auto again = answer({with(plain, 1, 2)}, "finder");
    again.kind = "finder.py";
    CHECK_FALSE(filter.first(again));
}

TEST_CASE(
    "answer filter: each plain receiver of lossless events answers for itself, also when one was given them again")
{
    AnswerFilter filter;
    const Share given{.of = "camera.image", .epoch = 1, .turn = 1, .attempt = 1, .to = "image"};
    const auto answer_of = [&](const std::string& drone, int attempt) {
        return answer({with(given, 1, attempt), own(drone + ".faces")}, drone);
    };
    CHECK(filter.first(answer_of("face-1", 1)));
    CHECK(filter.first(answer_of("face-2", 2)));
    CHECK_FALSE(filter.first(answer_of("face-1", 2)));
    CHECK_FALSE(filter.first(answer_of("face-2", 1)));
}

TEST_CASE(
    "answer filter: behind a group, two drones that each got a result both answer; two that one member each feeds "
    "are as one")
{
    const auto answer_of = [&](const std::string& drone, int attempt, int again, bool each) {
        const Share given{.of = "crop-" + std::to_string(attempt) + ".part",
                          .epoch = 1,
                          .turn = 1,
                          .attempt = again,
                          .each = each,
                          .to = "image"};
        return answer({with(turn_1, 1, attempt), given, own(drone + ".faces")}, drone);
    };
    AnswerFilter both;
    CHECK(both.first(answer_of("face-1", 1, 1, true)));
    CHECK(both.first(answer_of("face-2", 1, 2, true)));
    CHECK_FALSE(both.first(answer_of("face-2", 1, 1, true)));
    CHECK_FALSE(both.first(answer_of("face-1", 2, 1, true)));
    AnswerFilter one;
    CHECK(one.first(answer_of("face-1", 1, 1, false)));
    CHECK_FALSE(one.first(answer_of("face-2", 2, 1, false)));
}

TEST_CASE("answer filter: behind a group, who was one of several once answers for itself also when it is alone later")
{
    const auto answer_of = [&](const std::string& drone, int attempt, bool each) {
        const Share given{.of = "crop-1.part", .epoch = attempt, .turn = 1, .attempt = 1, .each = each, .to = "image"};
        return answer({with(turn_1, 1, attempt), given, own(drone + ".faces")}, drone);
    };
    for (const bool alone_first : {false, true}) {
        AnswerFilter filter;
        CHECK(filter.first(answer_of("face-2", 1, !alone_first)));
        CHECK_FALSE(filter.first(answer_of("face-2", 2, alone_first)));
        CHECK(filter.first(answer_of("face-1", 2, alone_first)));
        CHECK_FALSE(filter.first(answer_of("face-1", 2, alone_first)));
        CHECK_FALSE(filter.first(answer_of("face-1", 3, false)));
    }
}

TEST_CASE("answer filter: workers of one group may call their inputs as they like")
{
    AnswerFilter filter;
    auto other = with(turn_1, 1, 2);
    other.to = "picture";
    CHECK(filter.first(answer({turn_1})));
    CHECK_FALSE(filter.first(answer({other}, "worker")));
}

TEST_CASE("answer filter: workers of one group are interchangeable also when they are of different kinds")
{
    const auto by = [](Event event, const char* kind) {
        event.kind = kind;
        return event;
    };
    AnswerFilter filter;
    CHECK(filter.first(by(answer({turn_1}), "face")));
    CHECK_FALSE(filter.first(by(answer({with(turn_1, 1, 2)}, "worker"), "python_face")));
    // So are those of a group behind that group. Another group, of another kind, does other work.
    const Share inner{.of = "face-1.faces#ages", .epoch = 3, .turn = 7, .attempt = 1, .to = "crop"};
    auto other = inner;
    other.of = "face-1.faces#moods";
    CHECK(filter.first(by(answer({turn_1, inner}, "age-1"), "age")));
    CHECK_FALSE(filter.first(by(answer({turn_1, with(inner, 7, 2)}, "age-2"), "python_age")));
    CHECK(filter.first(by(answer({turn_1, with(other, 7, 2)}, "mood-1"), "mood")));
}

TEST_CASE("answer filter: behind a group, a drone that was replaced by one of another kind is the same drone")
{
    const auto by = [](Event event, const char* kind) {
        event.kind = kind;
        return event;
    };
    const Share first{.of = "face-1.faces", .epoch = 3, .turn = 7, .attempt = 1, .to = "crop"};
    auto again = first;
    again.of = "face-2.faces";
    AnswerFilter filter;
    CHECK(filter.first(by(answer({turn_1, first}, "age"), "age")));
    CHECK_FALSE(filter.first(by(answer({with(turn_1, 1, 2), again}, "age"), "python_age")));
    CHECK(filter.first(by(answer({with(turn_1, 1, 2), again}, "mood"), "mood")));
}

TEST_CASE("answer filter: other outputs and parts are other answers, and so is the work of a restarted sender")
{
    AnswerFilter filter;
    CHECK(filter.first(answer({turn_1})));
    CHECK(filter.first(answer({with(turn_1, 1, 2)}, "face-2", "annotated")));
    CHECK(filter.first(answer({with(turn_1, 1, 2)}, "face-2", "faces", 1)));
    auto restarted = with(turn_1, 1, 2);
    restarted.epoch = 2;
    CHECK(filter.first(answer({restarted}, "face-2")));
}

TEST_CASE("answer filter: an identity that a replay gives again is another job, in a turn of its own")
{
    AnswerFilter filter;
    CHECK(filter.first(answer({turn_1})));
    CHECK(filter.first(answer({with(turn_1, 11, 1)})));
    CHECK_FALSE(filter.first(answer({with(turn_1, 11, 2)}, "face-2")));
}

TEST_CASE("answer filter: two groups of one name at two outputs are two works")
{
    AnswerFilter filter;
    auto other = with(turn_1, 1, 2);
    other.of = "camera.edges#workers";
    CHECK(filter.first(answer({turn_1})));
    CHECK(filter.first(answer({other})));
}

TEST_CASE("answer filter: of nested stages each attempt counts, however the inner one was shared")
{
    AnswerFilter filter;
    const auto inner = [](const std::string& by, int attempt) {
        return Share{.of = by + ".faces#crops", .epoch = 3, .turn = 7, .attempt = attempt, .to = "crop"};
    };
    CHECK(filter.first(answer({turn_1, inner("face-1", 1)}, "age-1")));
    CHECK_FALSE(filter.first(answer({turn_1, inner("face-1", 2)}, "age-2")));
    CHECK_FALSE(filter.first(answer({with(turn_1, 1, 2), inner("face-2", 1)}, "age-1")));
    CHECK(filter.first(answer({with(turn_1, 2, 1), inner("face-2", 1)}, "age-1")));
}

TEST_CASE("answer filter: events that nobody shares pass as often as they come")
{
    AnswerFilter filter;
    CHECK(filter.first(answer({})));
    CHECK(filter.first(answer({})));
}

TEST_CASE("answer filter: what its sender itself gives out once more is accepted once")
{
    AnswerFilter filter;
    for (const char* of : {"face-1.faces", "face-1.faces#workers"}) {
        CHECK(shares_behind(answer({own(of)})) == 0);
        CHECK(filter.first(answer({own(of, 2)})));
        CHECK_FALSE(filter.first(answer({own(of, 1)})));
        CHECK(filter.first(answer({with(own(of), 2, 1)})));
    }
    // The share before it still names the work.
    CHECK(shares_behind(answer({turn_1, own("face-1.faces")})) == 1);
    CHECK(filter.first(answer({turn_1, own("face-1.faces")})));
    CHECK_FALSE(filter.first(answer({turn_1, own("face-1.faces", 2)})));
    CHECK_FALSE(filter.first(answer({with(turn_1, 1, 2), own("face-2.faces")}, "face-2")));
}

TEST_CASE("answer filter: a receiver that changed between a group and a plain connection answers a work once")
{
    const Share given{.of = "camera.image", .epoch = 1, .turn = 1, .attempt = 1, .to = "image"};
    const Share shared{.of = "face-1.faces#age", .epoch = 2, .turn = 1, .to = "faces"};
    const Share plain{.of = "face-1.faces", .epoch = 3, .turn = 1, .to = "faces"};
    const auto in_group = answer({given, shared}, "age-1"), alone = answer({with(given, 1, 2), plain}, "age-1");
    AnswerFilter joins, leaves;
    CHECK(joins.first(alone));
    CHECK_FALSE(joins.first(in_group));
    CHECK(leaves.first(in_group));
    CHECK_FALSE(leaves.first(alone));
    // Another plain receiver answers for itself, whatever the group has answered.
    CHECK(leaves.first(answer({with(given, 1, 2), plain}, "age-2")));
}

TEST_CASE("answer filter: its memory is bounded")
{
    AnswerFilter filter;
    const auto most = static_cast<std::int64_t>(AnswerFilter::remembered);
    for (std::int64_t turn = 1; turn <= most + 1; ++turn)
        filter.first(answer({with(turn_1, turn, 1)}));
    CHECK(filter.first(answer({with(turn_1, 1, 2)})));
    CHECK_FALSE(filter.first(answer({with(turn_1, most, 2)})));
}

TEST_CASE("answer filter: its memory is bounded also where the names are long")
{
    AnswerFilter filter;
    const auto long_turn = [](std::int64_t turn, int attempt) {
        auto share = with(turn_1, turn, attempt);
        share.of = std::string(1 << 20, 'd') + ".image#workers";
        return answer({share});
    };
    for (std::int64_t turn = 1; turn <= 20; ++turn)
        CHECK(filter.first(long_turn(turn, 1)));
    CHECK(filter.first(long_turn(1, 2)));
    CHECK_FALSE(filter.first(long_turn(20, 2)));
}

}  // namespace hive::event
