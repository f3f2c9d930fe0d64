// The encodings of images by name.
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>

#include <optional>

namespace hive::vision {
namespace {

constexpr int default_quality = 80;

const std::vector<Encoding>& encodings()
{
    static const std::vector<Encoding> all{{"jpeg", "image/jpeg", 1, 100}, {"png", "image/png"}, {"raw", "image/raw"}};
    return all;
}

Body body_of(const cv::Mat& image, const std::string& word, std::optional<std::int64_t> quality)
{
    if (word == "raw")
        return encode_raw(image);
    return word == "png" ? encode_png(image) : encode_jpeg(image, static_cast<int>(quality.value_or(default_quality)));
}

Event encode(const Event& event, const std::string& text)
{
    const auto& encoding = encoding_named(encodings(), text);
    const auto quality = number_of(text);
    if (event.type == encoding.type && !quality)
        return event;
    const cv::Mat image = view(event, {.sixteen_bits = true});
    Event result = event;
    result.type = encoding.type;
    result.body = body_of(image, encoding.word, quality);
    result.size = result.body.size();
    for (const char* field : {"pixel_format", "stride"})
        result.header.erase(field);
    result.header.update(encoding.word == "raw" ? raw_header(image)
                                                : Json{{"width", image.cols}, {"height", image.rows}});
    return result;
}

}  // namespace

Encoder encoder() { return {.encodings = encodings(), .encode = encode}; }

}  // namespace hive::vision
