// One source, in order, with times.
#include <frame_order.hpp>

#include <doctest/doctest.h>

using frame_order::Order;

namespace {

hive::Event picture(const std::string& source, std::int64_t epoch, std::int64_t sequence,
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

TEST_CASE("order: later pictures of one source go on, skipped ones or not; another or a restarted source begins anew")
{
    Order order;
    CHECK_FALSE(order.goes_on(picture("camera", 1, 5)));
    CHECK(order.goes_on(picture("camera", 1, 6)));
    CHECK(order.goes_on(picture("camera", 1, 60)));
    CHECK_FALSE(order.goes_on(picture("camera", 2, 1)));
    CHECK_FALSE(order.goes_on(picture("door", 2, 2)));
    CHECK(order.goes_on(picture("door", 2, 3)));
}

TEST_CASE("order: a picture that comes late or twice is refused, and the sequence goes on without it")
{
    Order order;
    order.goes_on(picture("camera", 1, 5));
    for (const std::int64_t late : {5, 4})
        CHECK_THROWS_AS(order.goes_on(picture("camera", 1, late)), hive::Error);
    CHECK(order.goes_on(picture("camera", 1, 6)));
}

TEST_CASE("order: two sources in turns are refused but for one, until the other has been silent for 2 s")
{
    Order order;
    const auto at = [](const std::string& source, std::int64_t sequence, int milliseconds) {
        auto event = picture(source, 1, sequence);
        event.received += std::chrono::milliseconds(milliseconds);
        return event;
    };
    order.goes_on(at("left", 1, 0));
    CHECK_FALSE(order.goes_on(at("right", 1, 30)));
    CHECK_THROWS_WITH_AS(order.goes_on(at("left", 2, 60)),
                         "pictures of left and right come in turns, and tracks are those of one source", hive::Error);
    CHECK(order.goes_on(at("right", 2, 90)));
    CHECK_THROWS_AS(order.goes_on(at("left", 3, 2089)), hive::Error);
    CHECK_FALSE(order.goes_on(at("left", 4, 2090)));
    CHECK(order.goes_on(at("left", 5, 2120)));
}

TEST_CASE("order: a number that another drone said costs one picture, not all that follow")
{
    Order order;
    order.goes_on(picture("camera", 1, 5));
    CHECK(order.goes_on(picture("camera", 1, 1'000'000, "liar")));
    CHECK_THROWS_AS(order.goes_on(picture("camera", 1, 6)), hive::Error);
    CHECK(order.goes_on(picture("camera", 1, 7)));
}

TEST_CASE(
    "order: time is that in the file, or of the capture, not of the arrival, or counts pictures at a rate that was "
    "told")
{
    auto event = picture("camera", 1, 45);
    event.identity.monotonic_us = 2'500'000;
    CHECK(frame_order::time_of(event, 0) == doctest::Approx(2.5));
    CHECK(frame_order::time_of(event, 30) == doctest::Approx(1.5));
    event.header = {{"media_time_us", 4'400'000}};
    CHECK(frame_order::time_of(event, 0) == doctest::Approx(4.4));
    CHECK(frame_order::time_of(event, 30) == doctest::Approx(1.5));
    event.header = {{"media_time_us", "noon"}};
    CHECK(frame_order::time_of(event, 0) == doctest::Approx(2.5));
}
