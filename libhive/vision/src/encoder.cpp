// The encodings of pictures by their words.
#include <hive/error.hpp>
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>

#include <charconv>
#include <optional>

namespace hive::vision {
namespace {

constexpr int usual_quality = 80;

struct Encoding {
    std::string word;
    std::optional<int> quality;  ///< asked for

    [[nodiscard]] std::string type() const { return "image/" + word; }
};

[[noreturn]] void unknown(const std::string& encoding)
{
    throw Error(Errc::invalid_argument, "there is no encoding " + in_quotes(encoding),
                "there are raw, png, jpeg, and jpeg:1 to jpeg:100");
}

Encoding parse(const std::string& text)
{
    const auto colon = text.find(':');
    Encoding encoding{text.substr(0, colon), {}};
    if (encoding.word != "jpeg" && encoding.word != "png" && encoding.word != "raw")
        unknown(text);
    if (colon == std::string::npos)
        return encoding;
    int quality = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, problem] = std::from_chars(text.data() + colon + 1, end, quality);
    if (encoding.word != "jpeg" || problem != std::errc() || rest != end || quality < 1 || quality > 100)
        unknown(text);
    encoding.quality = quality;
    return encoding;
}

Body body_of(const cv::Mat& picture, const Encoding& encoding)
{
    if (encoding.word == "raw")
        return encode_raw(picture);
    return encoding.word == "png" ? encode_png(picture)
                                  : encode_jpeg(picture, encoding.quality.value_or(usual_quality));
}

Event encode(const Event& event, const std::string& text)
{
    const Encoding encoding = parse(text);
    if (event.type == encoding.type() && !encoding.quality)
        return event;
    const cv::Mat picture = view(event, {.sixteen_bits = true});
    Event result = event;
    result.type = encoding.type();
    result.body = body_of(picture, encoding);
    result.size = result.body.size();
    for (const char* field : {"pixel_format", "stride"})
        result.header.erase(field);
    result.header.update(encoding.word == "raw" ? raw_header(picture)
                                                : Json{{"width", picture.cols}, {"height", picture.rows}});
    return result;
}

}  // namespace

Encoder encoder()
{
    return {.encodings = {"jpeg", "png", "raw"},
            .type = [](const std::string& text) { return parse(text).type(); },
            .encode = encode};
}

}  // namespace hive::vision
