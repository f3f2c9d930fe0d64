// Images that are bombs, cut short or damaged, put to the face drone: an exception, soon, and never a result.
#include "prey.hpp"

#include <doctest/doctest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <fstream>

using namespace hostile;

namespace {

std::string jpeg(cv::Size size, bool progressive = false)
{
    cv::Mat image(size, CV_8UC3);
    cv::randu(image, 0, 255);
    cv::blur(image, image, {9, 9});
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, progressive});
    return {bytes.begin(), bytes.end()};
}

std::size_t marker(const std::string& bytes, unsigned char first, unsigned char last, std::size_t from = 2)
{
    for (std::size_t at = from; at + 1 < bytes.size(); ++at)
        if (bytes[at] == '\xFF' && static_cast<unsigned char>(bytes[at + 1]) >= first
            && static_cast<unsigned char>(bytes[at + 1]) <= last)
            return at;
    return bytes.size();
}

/// The same JPEG, claiming another size.
std::string claiming(std::string bytes, int width, int height)
{
    const auto frame = marker(bytes, 0xC0, 0xC2);
    for (const auto& [at, number] : {std::pair(frame + 5, height), std::pair(frame + 7, width)}) {
        bytes[at] = static_cast<char>(number >> 8);
        bytes[at + 1] = static_cast<char>(number);
    }
    return bytes;
}

/// A progressive JPEG with its first scan again and again.
std::string with_scans(const std::string& bytes, int scans)
{
    const auto first = marker(bytes, 0xDA, 0xDA), second = marker(bytes, 0xC4, 0xDA, first + 2);
    std::string result = bytes.substr(0, first);
    for (int i = 0; i < scans; ++i)
        result += bytes.substr(first, second - first);
    return result + "\xFF\xD9";
}

std::string file(const std::filesystem::path& path)
{
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Puts images to a face drone and takes what comes of them.
class Sitting {
public:
    Sitting()
    {
        const auto listen = [&](const char* output, int channel) {
            const Json registration{
                {"epoch", 1}, {"output", output}, {"receiver", "raw"}, {"options", {{"transfer", "stream"}}}};
            REQUIRE(raw::error_of(peer_.ask(raw::register_, registration, channel)) == "");
        };
        listen("annotated", 1);
        listen("faces", 2);
        listen("exceptions", 3);
    }

    /// "annotated", or the code of the exception that the image gave.
    std::string result_of(const std::string& type, const std::string& body, const Json& header = Json::object())
    {
        const Json fields{{"id", ++id_}, {"input", "image"}, {"type", type}, {"header", header}};
        if (!peer_.send(raw::packet(raw::put, 0, fields.dump(), body)))
            return "not taken";
        const auto begin = Clock::now();
        while (const auto packet = peer_.next(within(5000))) {
            took = std::chrono::duration_cast<Milliseconds>(Clock::now() - begin);
            if (packet->type == raw::exception)
                return packet->json().at("header").at("code");
            if (packet->type == raw::event && packet->channel == 1)
                return "annotated";
        }
        return "nothing came";
    }

    Prey prey = Prey::face();
    Milliseconds took{};

private:
    raw::Peer peer_ = prey.meet();
    int id_ = 1000;
};

}  // namespace

TEST_CASE("hostile image: bombs are refused as too large within 200 ms, at no memory")
{
    Sitting sitting;
    const std::string plain = jpeg({64, 64}), progressive = jpeg({320, 240}, true);
    REQUIRE(sitting.result_of("image/jpeg", plain) == "annotated");
    const auto memory = hive::test::resident_bytes(sitting.prey.pid());
    std::vector<std::pair<std::string, std::string>> bombs{
        {"65500 x 65500", claiming(plain, 65500, 65500)},
        {"32000 x 32000", claiming(plain, 32000, 32000)},
        {"65535 x 641", claiming(plain, 65535, 641)},
        {"progressive 32000 x 32000", claiming(progressive, 32000, 32000)},
        {"1000 scans", with_scans(progressive, 1000)},
        {"101 scans", with_scans(progressive, 101)}};
    if (const auto folder = hive::test::shared_data("hostile"))
        for (const char* name : {"pixels-1gp.jpg", "scans-1000.jpg"})
            bombs.emplace_back(name, file(*folder / name));
    else
        MESSAGE("without the collected bombs: no folder hostile in the shared data");
    for (const auto& [what, bytes] : bombs) {
        CAPTURE(what);
        auto fastest = Milliseconds::max();
        for (int i = 0; i < 3 && fastest >= hive::test::stated(Milliseconds(200)); ++i) {
            CHECK(sitting.result_of("image/jpeg", bytes) == "too_large");
            fastest = std::min(fastest, sitting.took);
        }
        CHECK(fastest < hive::test::stated(Milliseconds(200)));
    }
    if (!hive::test::sanitized())
        CHECK(hive::test::resident_bytes(sitting.prey.pid()) < memory + (8u << 20));
    CHECK(sitting.result_of("image/jpeg", plain) == "annotated");
    CHECK(sitting.prey.well());
}

TEST_CASE("hostile image: a JPEG cut anywhere is malformed and never gives an annotated image; whole it does")
{
    Sitting sitting;
    for (const bool progressive : {false, true}) {
        const std::string whole = jpeg({160, 120}, progressive);
        for (std::size_t size = 0; size + 4 < whole.size(); size += whole.size() / 40) {
            CAPTURE(size);
            CHECK(sitting.result_of("image/jpeg", whole.substr(0, size)) == "malformed");
            CHECK(sitting.result_of("image/jpeg", whole.substr(0, size) + "\xFF\xD9") == "malformed");
        }
        std::string half = whole.substr(0, whole.size() * 3 / 4) + "\xFF\xD9";
        CHECK_FALSE(cv::imdecode(std::vector<unsigned char>(half.begin(), half.end()), cv::IMREAD_COLOR)
                        .empty());  // the twin: OpenCV alone takes three quarters for an image
        CHECK(sitting.result_of("image/jpeg", whole) == "annotated");
    }
    CHECK(sitting.prey.well());
}

TEST_CASE("hostile image: a raw image whose header does not fit its body is malformed")
{
    Sitting sitting;
    const std::string body(64 * 48 * 3, 'p');
    const Json right{{"width", 64}, {"height", 48}, {"pixel_format", "bgr8"}, {"stride", 192}};
    REQUIRE(sitting.result_of("image/raw", body, right) == "annotated");
    const std::vector<std::pair<const char*, Json>> lies{{"width", 65},
                                                         {"width", 0},
                                                         {"width", -64},
                                                         {"width", 4294967296},
                                                         {"width", "64"},
                                                         {"width", 1.5},
                                                         {"height", 49},
                                                         {"height", 0},
                                                         {"height", 9007199254740992},
                                                         {"stride", 191},
                                                         {"stride", 0},
                                                         {"stride", -192},
                                                         {"stride", 9007199254740992},
                                                         {"pixel_format", "rgba16"},
                                                         {"pixel_format", 3}};
    for (const auto& [field, value] : lies) {
        Json header = right;
        header[field] = value;
        CAPTURE(header);
        const auto result = sitting.result_of("image/raw", body, header);
        CHECK_MESSAGE((result == "malformed" || result == "too_large" || result == "unsupported"), result);
    }
    CHECK(sitting.result_of("image/raw", body.substr(1), right) == "malformed");
    CHECK(sitting.prey.well());
}
