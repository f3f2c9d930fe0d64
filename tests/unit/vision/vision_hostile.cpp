// Bad images: cut short, bombs, damaged. They are refused before they cost anything, and never come out in part.
#include "media.hpp"

#include <doctest/doctest.h>
#include <hive/error.hpp>
#include <hive/vision/image.hpp>
#include <opencv2/imgcodecs.hpp>
#include <zlib.h>

#include <algorithm>
#include <chrono>
#include <optional>

using hive::Body;
using hive::Errc;
namespace vision = hive::vision;

namespace {

/// Why it was refused; empty if it was decoded.
std::optional<Errc> refusal(const Body& body, const std::string& type, const vision::DecodeLimits& limits = {})
{
    try {
        vision::decode(body, type, limits);
        return std::nullopt;
    } catch (const hive::Error& error) {
        return error.code();
    }
}

/// How long the refusal takes: the fastest of three, in milliseconds, for the machine may be busy with something else.
double milliseconds_to_refuse(const Body& body, const std::string& type)
{
    double best = 1e9;
    for (int i = 0; i < 3; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        refusal(body, type);
        best =
            std::min(best, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    }
    return best;
}

std::size_t find_marker(const media::Bytes& jpeg, unsigned char first, unsigned char last, std::size_t from = 2)
{
    for (std::size_t at = from; at + 1 < jpeg.size(); ++at)
        if (jpeg[at] == 0xFF && jpeg[at + 1] >= first && jpeg[at + 1] <= last)
            return at;
    return jpeg.size();
}

media::Bytes with_size(media::Bytes jpeg, unsigned width, unsigned height)
{
    const std::size_t sof = find_marker(jpeg, 0xC0, 0xC2);
    REQUIRE(sof < jpeg.size());
    jpeg[sof + 5] = static_cast<unsigned char>(height >> 8);
    jpeg[sof + 6] = static_cast<unsigned char>(height);
    jpeg[sof + 7] = static_cast<unsigned char>(width >> 8);
    jpeg[sof + 8] = static_cast<unsigned char>(width);
    return jpeg;
}

/// A JPEG with its first scan repeated until there are `scans`.
media::Bytes with_scans(const media::Bytes& jpeg, int scans)
{
    const std::size_t first = find_marker(jpeg, 0xDA, 0xDA), second = find_marker(jpeg, 0xC4, 0xDA, first + 2);
    media::Bytes result(jpeg.begin(), jpeg.begin() + static_cast<std::ptrdiff_t>(first));
    for (int i = 0; i < scans; ++i)
        result.insert(result.end(), jpeg.begin() + static_cast<std::ptrdiff_t>(first),
                      jpeg.begin() + static_cast<std::ptrdiff_t>(second));
    result.insert(result.end(), {0xFF, 0xD9});
    return result;
}

const std::vector<std::vector<int>> jpeg_kinds{
    {}, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}, {cv::IMWRITE_JPEG_RST_INTERVAL, 1}};

}  // namespace

TEST_CASE("hostile JPEG: one that is cut short anywhere is refused, with or without an end marker glued on")
{
    for (const auto& kind : jpeg_kinds) {
        const media::Bytes whole = media::encoded(".jpg", media::sample({160, 120}, CV_8UC3), kind);
        REQUIRE_FALSE(refusal(whole, "image/jpeg"));
        for (std::size_t size = 0; size < whole.size() - 4; size += size < 700 ? 1 : 13) {
            CAPTURE(size);
            media::Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
            CHECK(refusal(cut, "image/jpeg") == Errc::malformed);
            cut.insert(cut.end(), {0xFF, 0xD9});
            CHECK(refusal(cut, "image/jpeg") == Errc::malformed);
        }
    }
}

TEST_CASE("hostile JPEG: a progressive one cut exactly between two scans is refused")
{
    const media::Bytes whole =
        media::encoded(".jpg", media::sample({160, 120}, CV_8UC3), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
    int cuts = 0;
    for (std::size_t at = find_marker(whole, 0xDA, 0xDA);
         (at = find_marker(whole, 0xC4, 0xDA, at + 2)) < whole.size();) {
        if (whole[at + 1] >= 0xD0 && whole[at + 1] <= 0xD9)
            continue;
        media::Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(at));
        cut.insert(cut.end(), {0xFF, 0xD9});
        CHECK_FALSE(cv::imdecode(cut, cv::IMREAD_COLOR).empty());  // OpenCV takes it for whole
        CHECK(refusal(cut, "image/jpeg") == Errc::malformed);
        ++cuts;
    }
    CHECK(cuts >= 5);
}

TEST_CASE("hostile JPEG: a size over the limit is refused within 5 ms")
{
    struct Case {
        unsigned width, height;
    };
    for (const auto& kind : jpeg_kinds)
        for (const Case size : {Case{65500, 65500}, {65535, 65535}, {32000, 32000}, {40001, 1000}, {8000, 5001}}) {
            const media::Bytes bomb =
                with_size(media::encoded(".jpg", media::sample({64, 64}, CV_8UC3), kind), size.width, size.height);
            CHECK(refusal(bomb, "image/jpeg") == Errc::too_large);
            CHECK(milliseconds_to_refuse(bomb, "image/jpeg") < 5);
        }
}

TEST_CASE("hostile JPEG: a size that the data do not fill is refused")
{
    const media::Bytes jpeg = media::encoded(".jpg", media::sample({64, 64}, CV_8UC3));
    CHECK(refusal(with_size(jpeg, 64, 80), "image/jpeg") == Errc::malformed);
    CHECK(refusal(with_size(jpeg, 8000, 5000), "image/jpeg") == Errc::malformed);
    CHECK(refusal(with_size(jpeg, 0, 64), "image/jpeg") == Errc::malformed);
    CHECK(refusal(with_size(jpeg, 64, 0), "image/jpeg") == Errc::malformed);
}

TEST_CASE("hostile JPEG: more than 100 scans are refused within 5 ms")
{
    const media::Bytes jpeg =
        media::encoded(".jpg", media::sample({640, 480}, CV_8UC3), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
    const media::Bytes bomb = with_scans(jpeg, 1000);
    CHECK(refusal(with_scans(jpeg, 101), "image/jpeg") == Errc::too_large);
    CHECK(refusal(with_scans(jpeg, 100), "image/jpeg") == Errc::malformed);  // counted, then found incomplete
    CHECK(milliseconds_to_refuse(bomb, "image/jpeg") < 5);
}

TEST_CASE("hostile JPEG: many scans of a large image are refused although each alone is allowed")
{
    const media::Bytes jpeg =
        media::encoded(".jpg", media::sample({64, 48}, CV_8UC3), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
    vision::DecodeLimits limits;
    limits.pixel_scans = 64 * 48 * 3;
    CHECK_FALSE(refusal(jpeg, "image/jpeg"));
    CHECK(refusal(jpeg, "image/jpeg", limits) == Errc::too_large);
}

TEST_CASE("hostile JPEG: the collected bombs are refused within 5 ms (needs media)")
{
    if (const auto folder = media::shared("hostile"))
        for (const char* name : {"pixels-1gp.jpg", "scans-1000.jpg"}) {
            const media::Bytes bomb = media::read(*folder / name);
            CHECK(refusal(bomb, "image/jpeg") == Errc::too_large);
            CHECK(milliseconds_to_refuse(bomb, "image/jpeg") < 5);
        }
}

TEST_CASE("hostile PNG: a size over the limit is refused within 5 ms")
{
    media::Bytes png = media::encoded(".png", media::sample({20, 20}, CV_8UC3));
    for (const unsigned char high : {0x00, 0x7F, 0xFF}) {
        png[16] = png[20] = high;  // the widths and heights 65556, 2139160596 and 4278255636
        png[17] = png[21] = 1;
        CHECK(refusal(png, "image/png") == Errc::malformed);  // by the check sum of its header
        const auto sum = ::crc32(0, png.data() + 12, 17);
        for (std::size_t i = 0; i < 4; ++i)
            png[29 + i] = static_cast<unsigned char>(sum >> (24 - 8 * i));
        CHECK(refusal(png, "image/png") == (high == 0xFF ? Errc::malformed : Errc::too_large));
        CHECK(milliseconds_to_refuse(png, "image/png") < 5);
    }
}

TEST_CASE("hostile PNG: one that is cut short or damaged anywhere is refused")
{
    const media::Bytes whole = media::encoded(".png", media::sample({60, 40}, CV_8UC3));
    for (std::size_t size = 0; size < whole.size(); size += size < 100 ? 1 : 37) {
        CAPTURE(size);
        CHECK(refusal(media::Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)), "image/png")
              == Errc::malformed);
    }
    media::Bytes damaged = whole;
    damaged[damaged.size() / 2] ^= 1;
    CHECK(refusal(damaged, "image/png") == Errc::malformed);
}

TEST_CASE("hostile images: with any bytes changed, the result is an image within the limits or an error")
{
    cv::RNG random(7);
    const vision::DecodeLimits limits{100'000, 20, 1'000'000};
    const cv::Mat image = media::sample({64, 48}, CV_8UC3);
    for (const char* suffix : {".jpg", ".png"})
        for (const auto& kind : jpeg_kinds) {
            const std::string type = suffix == std::string(".jpg") ? "image/jpeg" : "image/png";
            const media::Bytes whole = media::encoded(suffix, image, type == "image/jpeg" ? kind : std::vector<int>{});
            for (int round = 0; round < 300; ++round) {
                media::Bytes changed = whole;
                for (int i = random.uniform(1, 6); i > 0; --i)
                    changed[static_cast<std::size_t>(
                        random.uniform(0, static_cast<int>(round % 2 ? changed.size() : 300)))] =
                        static_cast<unsigned char>(random.uniform(0, 256));
                try {
                    const cv::Mat decoded = vision::decode(Body(changed), type, limits);
                    CHECK(decoded.type() == CV_8UC3);
                    CHECK(static_cast<std::int64_t>(decoded.total()) <= limits.pixels);
                } catch (const hive::Error&) {  // as good an answer
                }
            }
        }
}
