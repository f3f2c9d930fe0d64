// Counts that were not taken at one instant balance all the same, and counts that cannot be right are found.
#include <hive/audit.hpp>

#include <doctest/doctest.h>

using namespace hive;

namespace {

constexpr std::int64_t shared_registration = 7, sender_epoch = 100, receiver_epoch = 200;

struct Counts {
    std::int64_t came = 0, acknowledged = 0, processed = 0;
};

/// One look at a sender and its receiver.
std::vector<StatusAnswer> look(const Counts& counts, std::int64_t receiver_began = receiver_epoch)
{
    EdgeStatus edge{.receiver = "face.image", .connected = true, .registration = shared_registration};
    edge.events.came(counts.came);
    edge.events.went(Fate::acknowledged, counts.acknowledged);
    Status camera{.name = "camera", .kind = "camera", .epoch = sender_epoch};
    camera.outputs.push_back({.name = "image", .type = {}, .produced = counts.came, .edges = {edge}});
    Status face{.name = "face", .kind = "face", .epoch = receiver_began};
    face.inputs.push_back({.input = "image",
                           .from = "camera.image",
                           .connected = true,
                           .registration = shared_registration,
                           .received = counts.processed,
                           .processed = counts.processed});
    const Place here{.drone = {}, .host = Place::here, .address = "unix:/x"};
    return {{.drone = "camera", .status = camera, .place = here}, {.drone = "face", .status = face, .place = here}};
}

}  // namespace

TEST_CASE("audit: what goes on between two looks is no difference")
{
    const auto first = look({10, 9, 9}), second = look({60, 58, 59}), third = look({100, 98, 99});
    const auto found = audit(first, second, third);
    REQUIRE(found.rows.size() == 1);
    CHECK(found.rows[0].sender_answers);
    CHECK(found.rows[0].receiver_answers);
    CHECK(found.clean());
}

TEST_CASE("audit: a receiver that has processed more than was sent to it is found")
{
    const auto found = audit(look({10, 9, 9}), look({12, 12, 13}), look({12, 12, 13}));
    REQUIRE(found.rows[0].differences.size() == 1);
    CHECK(found.rows[0].differences[0] == "the receiver has processed 13 events, of which the sender has sent 12");
    CHECK_FALSE(found.clean());
    // A receiver that was there before the sender may have had them from an earlier run of it.
    constexpr auto before = sender_epoch - 1;
    CHECK(audit(look({10, 9, 9}, before), look({12, 12, 13}, before), look({12, 12, 13}, before)).clean());
}

TEST_CASE("audit: a sender that knows of more than its receiver has dealt with is found")
{
    constexpr auto before = sender_epoch - 1;
    const auto found = audit(look({10, 10, 9}, before), look({10, 10, 9}, before), look({10, 10, 9}, before));
    REQUIRE(found.rows[0].differences.size() == 1);
    CHECK(found.rows[0].differences[0] == "the sender counts 10 acknowledged events, and the receiver reports 9");
    // A receiver that was started later may have been there before, too.
    CHECK(audit(look({10, 10, 9}), look({10, 10, 9}), look({10, 10, 9})).clean());
}

TEST_CASE("audit: the last two looks are compared, so an old first look hides nothing")
{
    constexpr auto before = sender_epoch - 1;
    const auto acknowledged = audit(look({0, 0, 0}, before), look({10, 10, 9}, before), look({10, 10, 9}, before));
    CHECK(acknowledged.rows[0].differences.size() == 1);
    CHECK(audit(look({0, 0, 0}), look({12, 12, 13}), look({12, 12, 13})).rows[0].differences.size() == 1);
    // Acknowledged between the two looks.
    CHECK(audit(look({0, 0, 0}, before), look({10, 9, 9}, before), look({20, 20, 20}, before)).clean());
}

TEST_CASE("audit: a drone that was started after the first look is compared by the other two")
{
    const auto found = audit({}, look({12, 12, 13}), look({12, 12, 13}));
    CHECK(found.rows[0].sender_answers);
    CHECK(found.rows[0].receiver_answers);
    CHECK(found.rows[0].differences.size() == 1);
    auto apart = look({10, 10, 10});
    std::get<Status>(apart[1].status).inputs.clear();
    CHECK(audit({}, apart, apart).clean());  // it may still be connecting
    CHECK(audit(look({10, 10, 10}, receiver_epoch - 1), apart, apart).clean());
}

TEST_CASE("audit: ends that do not know of each other are found, unless one look shows that they do")
{
    auto apart = look({10, 10, 10});
    std::get<Status>(apart[1].status).inputs.clear();
    CHECK(audit(apart, apart, apart).rows[0].differences.at(0)
          == "the sender has it registered, and the receiver is not connected");
    CHECK(audit(look({10, 10, 10}), apart, apart).clean());
    auto unknown = look({10, 10, 10});
    std::get<Status>(unknown[0].status).outputs[0].edges.clear();
    CHECK(audit(unknown, unknown, unknown).rows[0].differences.at(0)
          == "the receiver is connected, and the sender has no such registration");
    CHECK(audit(unknown, look({10, 10, 10}), unknown).clean());
}

TEST_CASE("audit: what an input has lost stays after its connection was closed")
{
    auto closed = look({10, 10, 10});
    auto& face = std::get<Status>(closed[1].status);
    face.left.push_back(face.inputs[0]);
    face.left[0].from = "";
    CHECK(audit(closed, closed, closed).rows.size() == 1);
    face.left[0].received += 5;
    face.left[0].abandoned = 2;
    face.left[0].discarded = 3;
    const auto found = audit(closed, closed, closed);
    REQUIRE(found.rows.size() == 2);
    CHECK(found.rows[1].lost() == 2);
    CHECK_FALSE(found.clean());
    const auto row = to_json(found.rows[1]);
    CHECK(row.at("from") == "closed connections");
    CHECK(row.at("to") == "face.image");
    CHECK(row.at("state") == "closed");
    CHECK(row.at("came").is_null());
    CHECK(row.at("fates") == "2 abandoned at face");
}

TEST_CASE("audit: events are lost where they were promised, and a drone that does not answer is named")
{
    auto lossy = look({20, 10, 10});
    auto& edge = std::get<Status>(lossy[0].status).outputs[0].edges[0];
    edge.events.went(Fate::skipped, 5);
    edge.events.went(Fate::lost_left, 1);
    CHECK(audit(lossy, lossy, lossy).clean());
    edge.events.went(Fate::lost_killed, 2);
    auto found = audit(lossy, lossy, lossy);
    CHECK(found.rows[0].lost() == 2);
    CHECK_FALSE(found.clean());
    auto& input = std::get<Status>(lossy[1].status).inputs[0];
    input.received += 3;
    input.abandoned += 3;
    CHECK(audit(lossy, lossy, lossy).rows[0].lost() == 5);
    input.received += 1;
    CHECK(audit(lossy, lossy, lossy).rows[0].differences.at(0)
          == "the receiver's counts do not add up to the 14 events that it has received");
    lossy[1].status = Error(Errc::timeout, "no answer");
    found = audit(lossy, lossy, lossy);
    CHECK(found.silent == std::vector<std::string>{"face"});
    CHECK_FALSE(found.rows[0].receiver_answers);
}
