// The bytes of an MJPEG stream.
#include "stream.hpp"

#include <doctest/doctest.h>

using namespace std::chrono_literals;
using view::Exchange;

namespace {

view::Jpeg bytes(const std::string& text)
{
    return std::make_shared<const std::vector<unsigned char>>(text.begin(), text.end());
}

std::shared_ptr<const view::Image> image(const std::string& jpeg)
{
    return std::make_shared<const view::Image>(view::Origin{}, view::Image::Content{{}, bytes(jpeg)},
                                               view::Image::Look{.overlay = false});
}

view::Stream::Newest newest_of(const Exchange& exchange)
{
    return [&exchange](Exchange::Time now) {
        const auto newest = exchange.newest(now);
        return view::Encoded{newest.image->jpeg(), newest.version};
    };
}

std::string part(const std::string& jpeg)
{
    return "Content-Type: image/jpeg\r\nContent-Length: " + std::to_string(jpeg.size()) + "\r\n\r\n" + jpeg
           + "\r\n--picture\r\n";
}

/// What a reader gets that takes `step` bytes at a time, until there is nothing.
std::string read(view::Stream& stream, Exchange::Time now, std::size_t step = 7)
{
    std::string all, some(step, '?');
    while (const auto count = stream.read(some, now))
        all.append(some, 0, count);
    return all;
}

const Exchange::Time now{1000s};

}  // namespace

TEST_CASE(
    "stream: each image once, in parts that end with the boundary of the next, whatever the reader takes at a time")
{
    for (const std::size_t step : {1UL, 7UL, 1000UL}) {
        Exchange exchange(image("notice"));
        view::Stream stream(newest_of(exchange), 2s);
        CHECK(read(stream, now, step) == "--picture\r\n" + part("notice"));
        CHECK(read(stream, now, step) == "");
        exchange.put(image("first"));
        CHECK(read(stream, now, step) == part("first"));
        CHECK(read(stream, now, step) == "");
    }
}

TEST_CASE("stream: a reader in the middle of an image gets the rest, and then the newest")
{
    Exchange exchange(image("notice"));
    view::Stream stream(newest_of(exchange), 2s);
    std::string some(20, '?');
    REQUIRE(stream.read(some, now) == 20);
    for (const char* jpeg : {"first", "second", "third"})
        exchange.put(image(jpeg));
    CHECK(some + read(stream, now) == "--picture\r\n" + part("notice") + part("third"));
}

TEST_CASE("stream: the last image is repeated after a delay without a newer one")
{
    Exchange exchange(image("notice"));
    view::Stream stream(newest_of(exchange), 2s);
    read(stream, now);
    CHECK(read(stream, now + 1999ms) == "");
    CHECK(read(stream, now + 2s) == part("notice"));
    CHECK(read(stream, now + 3s) == "");
}

TEST_CASE("stream: a stalled reader keeps its current JPEG only")
{
    Exchange exchange(image("notice"));
    std::weak_ptr<const view::Image> read_by_it;
    {
        const auto first = image("first");
        exchange.put(first);
        read_by_it = first;
    }
    view::Stream stream(newest_of(exchange), 2s);
    std::string some(20, '?');
    REQUIRE(stream.read(some, now) == 20);
    exchange.put(image("second"));
    CHECK(read_by_it.expired());
}
