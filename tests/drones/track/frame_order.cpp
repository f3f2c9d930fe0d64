// One source, in order, with times.
#include <frame_order.hpp>

#include <doctest/doctest.h>

using frame_order::Order;

namespace {

hive::Event frame(const std::string& source, std::int64_t epoch, std::int64_t sequence,
                  const std::string& sender = "face")
{
    hive::Event event;
    event.sender = sender;
    event.identity.source = source;
    event.identity.epoch = epoch;
    event.identity.sequence = sequence;
    return event;
}

}  // namespace

TEST_CASE("order: later frames of a source continue, with or without gaps; another or restarted source resets")
{
    Order order;
    CHECK_FALSE(order.continues(frame("camera", 1, 5)));
    CHECK(order.continues(frame("camera", 1, 6)));
    CHECK(order.continues(frame("camera", 1, 60)));
    CHECK_FALSE(order.continues(frame("camera", 2, 1)));
    CHECK_FALSE(order.continues(frame("door", 2, 2)));
    CHECK(order.continues(frame("door", 2, 3)));
}

TEST_CASE("order: a late or repeated frame is refused, and the sequence continues")
{
    Order order;
    order.continues(frame("camera", 1, 5));
    for (const std::int64_t late : {5, 4})
        CHECK_THROWS_AS(order.continues(frame("camera", 1, late)), hive::Error);
    CHECK(order.continues(frame("camera", 1, 6)));
}

TEST_CASE("order: two sources in turns are refused but for one, until the other has been silent for 2 s")
{
    Order order;
    const auto at = [](const std::string& source, std::int64_t sequence, int milliseconds) {
        auto event = frame(source, 1, sequence);
        event.received += std::chrono::milliseconds(milliseconds);
        return event;
    };
    order.continues(at("left", 1, 0));
    CHECK_FALSE(order.continues(at("right", 1, 30)));
    CHECK_THROWS_WITH_AS(order.continues(at("left", 2, 60)),
                         "frames of left and right alternate, but tracks need a single source", hive::Error);
    CHECK(order.continues(at("right", 2, 90)));
    CHECK_THROWS_AS(order.continues(at("left", 3, 2089)), hive::Error);
    CHECK_FALSE(order.continues(at("left", 4, 2090)));
    CHECK(order.continues(at("left", 5, 2120)));
}

TEST_CASE("order: a wrong number from another drone costs one frame, not all later ones")
{
    Order order;
    order.continues(frame("camera", 1, 5));
    CHECK(order.continues(frame("camera", 1, 1'000'000, "liar")));
    CHECK_THROWS_AS(order.continues(frame("camera", 1, 6)), hive::Error);
    CHECK(order.continues(frame("camera", 1, 7)));
}

TEST_CASE("order: time is that in the file, or of the capture, not of the arrival, or counts frames at a rate that was "
          "told")
{
    auto event = frame("camera", 1, 45);
    event.identity.monotonic_us = 2'500'000;
    CHECK(frame_order::time_of(event, 0) == doctest::Approx(2.5));
    CHECK(frame_order::time_of(event, 30) == doctest::Approx(1.5));
    event.header = {{"media_time_us", 4'400'000}};
    CHECK(frame_order::time_of(event, 0) == doctest::Approx(4.4));
    CHECK(frame_order::time_of(event, 30) == doctest::Approx(1.5));
    event.header = {{"media_time_us", "noon"}};
    CHECK(frame_order::time_of(event, 0) == doctest::Approx(2.5));
}
