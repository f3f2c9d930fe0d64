// PNGs with more in them than an image: texts and profiles that inflate to a thousand times their size, pixels after
// the last one. They cost what the image costs, or are refused.
#include "media.hpp"

#include <doctest/doctest.h>
#include <hive/error.hpp>
#include <hive/vision/image.hpp>
#include <opencv2/imgcodecs.hpp>
#include <zlib.h>

#include <ctime>
#include <optional>

using hive::Body;
using hive::Errc;
namespace vision = hive::vision;

namespace {

media::Bytes big_endian(std::size_t number)
{
    return {static_cast<unsigned char>(number >> 24), static_cast<unsigned char>(number >> 16),
            static_cast<unsigned char>(number >> 8), static_cast<unsigned char>(number)};
}

void append(media::Bytes& to, const media::Bytes& bytes) { to.insert(to.end(), bytes.begin(), bytes.end()); }

media::Bytes chunk(const std::string& type, const media::Bytes& data)
{
    media::Bytes summed(type.begin(), type.end()), whole = big_endian(data.size());
    append(summed, data);
    append(whole, summed);
    append(whole, big_endian(::crc32(0, summed.data(), static_cast<uInt>(summed.size()))));
    return whole;
}

media::Bytes compressed(const media::Bytes& bytes)
{
    auto size = ::compressBound(bytes.size());
    media::Bytes result(size);
    REQUIRE(::compress2(result.data(), &size, bytes.data(), bytes.size(), 9) == Z_OK);
    result.resize(size);
    return result;
}

struct Kind {
    unsigned char depth = 8, color = 2, interlace = 0;
};

media::Bytes header(unsigned width, unsigned height, Kind kind)
{
    media::Bytes data = big_endian(width);
    append(data, big_endian(height));
    append(data, {kind.depth, kind.color, 0, 0, kind.interlace});
    return chunk("IHDR", data);
}

/// A PNG of these chunks, between its header and its pixels.
media::Bytes png(const media::Bytes& head, const std::vector<media::Bytes>& chunks, const media::Bytes& pixels)
{
    media::Bytes whole{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    append(whole, head);
    for (const auto& one : chunks)
        append(whole, one);
    append(whole, chunk("IDAT", compressed(pixels)));
    append(whole, chunk("IEND", {}));
    return whole;
}

/// Black pixels, 2 x 2 with 3 bytes each, behind the filter of their row.
const media::Bytes four_pixels(14, 0);

media::Bytes with_chunks(const std::vector<media::Bytes>& chunks) { return png(header(2, 2, {}), chunks, four_pixels); }

/// "name", the bytes that come before the compressed part, and eight million letters.
media::Bytes text_bomb(const std::string& type, const std::string& before)
{
    static const media::Bytes letters = compressed(media::Bytes(7'900'000, 'A'));
    media::Bytes data(before.begin(), before.end());
    append(data, letters);
    return chunk(type, data);
}

double cpu_seconds()
{
    timespec now{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

#ifdef HIVE_SANITIZED
constexpr double timeout = 5;  // of a sanitizer
#else
constexpr double timeout = 1;
#endif

struct Outcome {
    std::optional<Errc> refusal;
    cv::Mat image;
    double seconds = 0;  ///< of the processor
};

Outcome decoded(const media::Bytes& bytes)
{
    Outcome outcome;
    const Body body(bytes);
    const double begin = cpu_seconds();
    try {
        outcome.image = vision::decode(body, "image/png");
    } catch (const hive::Error& error) {
        outcome.refusal = error.code();
    }
    outcome.seconds = cpu_seconds() - begin;
    return outcome;
}

}  // namespace

TEST_CASE("hostile PNG: texts and profiles are not inflated")
{
    using namespace std::string_literals;
    for (const auto& bomb :
         {text_bomb("zTXt", "name\0\0"s), text_bomb("iTXt", "name\0\1\0\0\0"s), text_bomb("iCCP", "name\0\0"s)}) {
        const auto outcome = decoded(with_chunks(std::vector(100, bomb)));
        CHECK_FALSE(outcome.refusal);
        CHECK(outcome.image.size() == cv::Size(2, 2));
        CHECK(outcome.seconds < 0.1 * timeout);
    }
}

TEST_CASE("hostile PNG: more data than the pixels are is not inflated; fewer are refused")
{
    for (const unsigned char interlace : {0, 1}) {
        const auto head = header(2, 2, {.interlace = interlace});
        const auto outcome = decoded(png(head, {}, media::Bytes(200'000'000, 0)));
        CHECK(outcome.refusal == Errc::malformed);
        CHECK(outcome.seconds < 0.1 * timeout);
        const std::size_t bytes = interlace ? 15 : 14;  // three passes of one row each, and two rows
        CHECK_FALSE(decoded(png(head, {}, media::Bytes(bytes, 0))).refusal);
        CHECK(decoded(png(head, {}, media::Bytes(bytes - 1, 0))).refusal == Errc::malformed);
    }
}

TEST_CASE("hostile PNG: half a million empty chunks cost nothing")
{
    const auto outcome = decoded(with_chunks(std::vector(500'000, chunk("teXt", {}))));
    CHECK_FALSE(outcome.refusal);
    CHECK(outcome.seconds < 0.2 * timeout);
}

TEST_CASE("hostile PNG: an unknown critical chunk and invalid types are refused")
{
    CHECK(decoded(with_chunks({chunk("NEWS", {1, 2, 3})})).refusal == Errc::malformed);
    auto late_header = with_chunks({});
    const auto text = chunk("teXt", {});
    late_header.insert(late_header.begin() + 8, text.begin(), text.end());
    CHECK(decoded(late_header).refusal == Errc::malformed);
    for (const Kind& kind : {Kind{3, 2, 0}, {8, 1, 0}, {16, 3, 0}, {4, 6, 0}, {8, 2, 2}, {8, 7, 0}, {0, 0, 0}})
        CHECK(decoded(png(header(2, 2, kind), {}, four_pixels)).refusal == Errc::malformed);
}

TEST_CASE("hostile PNG: what stands behind the pixels is read as far as the end, which must be there")
{
    const auto whole = with_chunks({});
    const media::Bytes text = chunk("tEXt", media::Bytes(100'000, 'x')), end(whole.end() - 12, whole.end());
    media::Bytes late(whole.begin(), whole.end() - 12);
    append(late, text);
    CHECK(decoded(late).refusal == Errc::malformed);
    append(late, end);
    CHECK_FALSE(decoded(late).refusal);
    media::Bytes more(whole.begin(), whole.end() - 12);
    append(more, chunk("IDAT", media::Bytes(2000, 0)));
    append(more, end);
    CHECK(decoded(more).refusal == Errc::malformed);
}

TEST_CASE("hostile PNG: EXIF of megabytes costs little and turns nothing")
{
    const media::Bytes sideways{'M', 'M', 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, 6, 0, 0, 0, 0, 0, 0};
    media::Bytes long_one = sideways;
    long_one.resize(7'000'000);
    const auto outcome = decoded(png(header(2, 1, {}), {chunk("eXIf", long_one)}, media::Bytes(7, 0)));
    CHECK_FALSE(outcome.refusal);
    CHECK(outcome.image.size() == cv::Size(2, 1));
    CHECK(outcome.seconds < 0.6 * timeout);
}

TEST_CASE("PNG: EXIF turns it as OpenCV does")
{
    const media::Bytes sideways{'M', 'M', 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, 6, 0, 0, 0, 0, 0, 0};
    const auto whole = png(header(2, 1, {}), {chunk("eXIf", sideways)}, {0, 10, 20, 30, 40, 50, 60});
    const auto outcome = decoded(whole);
    REQUIRE_FALSE(outcome.refusal);
    CHECK(media::same(outcome.image, cv::imdecode(whole, cv::IMREAD_COLOR)));
    media::Bytes late = png(header(2, 1, {}), {}, {0, 10, 20, 30, 40, 50, 60});
    const auto exif = chunk("eXIf", sideways);
    late.insert(late.end() - 12, exif.begin(), exif.end());
    CHECK(decoded(late).image.size() == cv::Size(1, 2));
}

TEST_CASE("PNG: every kind gives what OpenCV gives")
{
    const media::Bytes palette = chunk("PLTE", {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 0});
    const media::Bytes transparency = chunk("tRNS", {0, 128, 255});
    struct Case {
        Kind kind;
        std::size_t bytes;  ///< of 5 x 3 pixels: rows, or passes, with their filters
    };
    for (const auto& [kind, bytes] : {Case{{1, 0, 0}, 6},
                                      {{2, 0, 0}, 9},
                                      {{4, 0, 0}, 12},
                                      {{8, 0, 0}, 18},
                                      {{16, 0, 0}, 33},
                                      {{8, 2, 0}, 48},
                                      {{16, 2, 0}, 93},
                                      {{2, 3, 0}, 9},
                                      {{8, 4, 0}, 33},
                                      {{8, 6, 0}, 63},
                                      {{8, 2, 1}, 52}}) {
        CAPTURE(static_cast<int>(kind.depth));
        CAPTURE(static_cast<int>(kind.color));
        CAPTURE(static_cast<int>(kind.interlace));
        const std::vector<media::Bytes> chunks =
            kind.color == 3 ? std::vector{palette, transparency} : std::vector<media::Bytes>{};
        const auto whole = png(header(5, 3, kind), chunks, media::Bytes(bytes, 0));
        const auto outcome = decoded(whole);
        REQUIRE_FALSE(outcome.refusal);
        CHECK(media::same(outcome.image, cv::imdecode(whole, cv::IMREAD_COLOR)));
    }
}
