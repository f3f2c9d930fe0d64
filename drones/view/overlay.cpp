// Draws a strip of text whose size follows the image.
#include "overlay.hpp"

#include <hive/name.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstdio>

namespace view {
namespace {

constexpr int font = cv::FONT_HERSHEY_SIMPLEX;

/// Font scale with which the text is about a 28th of the image's height, or as wide as the image if that is less.
double scale_for(const std::string& text, cv::Size size)
{
    const double wanted = std::clamp(size.height / 28.0 / 26.0, 0.4, 3.0);
    int baseline = 0;
    const int width = std::max(1, cv::getTextSize(text, font, 1, 1, &baseline).width);
    return std::clamp((size.width - 8.0) / width, 0.2, wanted);
}

int thickness_for(double scale) { return std::max(1, static_cast<int>(scale * 1.5)); }

std::string one_digit(double number)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", number);
    return text;
}

}  // namespace

std::string age_text(std::chrono::milliseconds age)
{
    const auto ms = std::max<std::int64_t>(0, age.count());
    if (ms < 1000)
        return std::to_string(ms) + " ms";
    return ms < 60'000 ? one_digit(static_cast<double>(ms) / 1000) + " s"
                       : std::to_string((ms + 30'000) / 60'000) + " min";
}

std::string caption(const Origin& origin, std::chrono::system_clock::time_point now)
{
    std::string text = origin.sender;
    if (!origin.source.empty() && !hive::belongs_to(origin.sender, origin.source))
        text += " from " + origin.source;
    if (origin.rate > 0)
        text += "  " + one_digit(origin.rate) + " fps";
    if (origin.captured)
        text += "  " + age_text(std::chrono::duration_cast<std::chrono::milliseconds>(now - *origin.captured));
    return text;
}

cv::Mat with_caption(const cv::Mat& image, const std::string& text)
{
    cv::Mat drawn;
    if (image.channels() == 1)
        cv::cvtColor(image, drawn, cv::COLOR_GRAY2BGR);
    else
        image.copyTo(drawn);
    const double scale = scale_for(text, drawn.size());
    const int thickness = thickness_for(scale);
    int baseline = 0;
    const int height = cv::getTextSize(text, font, scale, thickness, &baseline).height;
    const int margin = std::max(2, height / 2), strip = std::min(drawn.rows, height + 2 * margin);
    cv::Mat lower = drawn.rowRange(drawn.rows - strip, drawn.rows);
    lower.convertTo(lower, -1, 0.3);
    cv::putText(drawn, text, {margin, drawn.rows - margin}, font, scale, cv::Scalar::all(240), thickness, cv::LINE_AA);
    return drawn;
}

cv::Mat notice(const std::string& text, cv::Size size)
{
    cv::Mat image(size, CV_8UC3, cv::Scalar(34, 30, 28));
    const double scale = scale_for(text, {size.width - size.width / 10, 2 * size.height});
    int baseline = 0;
    const cv::Size box = cv::getTextSize(text, font, scale, thickness_for(scale), &baseline);
    cv::putText(image, text, {(size.width - box.width) / 2, (size.height + box.height) / 2}, font, scale,
                cv::Scalar::all(170), thickness_for(scale), cv::LINE_AA);
    return image;
}

}  // namespace view
