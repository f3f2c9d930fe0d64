// Enumerates formats, sizes and intervals, as in the V4L2 documentation (section 3.1, "Enumerating formats").
#include "words/video_device.hpp"

#include <cmath>
#include <cstring>
#include <linux/videodev2.h>

namespace hivectl {
namespace {

constexpr unsigned most_formats = 64, most_sizes = 128, most_rates = 64;

/// The text of a field that may lack its terminating zero.
template <std::size_t Size>
std::string text_of(const unsigned char (&field)[Size])
{
    const auto* begin = reinterpret_cast<const char*>(field);
    return {begin, ::strnlen(begin, Size)};
}

std::string letters_of(unsigned format)
{
    std::string text;
    for (int shift = 0; shift < 32; shift += 8)
        if (const auto letter = static_cast<char>(format >> shift & 0x7F); letter != ' ')
            text += letter > ' ' && letter < 0x7F ? letter : '?';
    return text + ((format >> 31) != 0 ? " (big-endian)" : "");
}

std::string size_text(unsigned width, unsigned height) { return std::to_string(width) + "x" + std::to_string(height); }

void add_rate(std::vector<double>& rates, const v4l2_fract& interval)
{
    if (interval.numerator > 0 && interval.denominator > 0)
        rates.push_back(std::round(1000.0 * interval.denominator / interval.numerator) / 1000);
}

std::vector<double> rates_of(const AskDriver& ask, unsigned format, unsigned width, unsigned height)
{
    std::vector<double> rates;
    v4l2_frmivalenum one{};
    one.pixel_format = format;
    one.width = width;
    one.height = height;
    for (one.index = 0; one.index < most_rates && ask(VIDIOC_ENUM_FRAMEINTERVALS, &one); ++one.index) {
        if (one.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
            add_rate(rates, one.discrete);
            continue;
        }
        add_rate(rates, one.stepwise.max);  // the longest interval is the lowest rate
        add_rate(rates, one.stepwise.min);
        break;
    }
    return rates;
}

void add_modes(std::vector<VideoMode>& modes, const AskDriver& ask, unsigned format)
{
    v4l2_frmsizeenum one{};
    one.pixel_format = format;
    for (one.index = 0; one.index < most_sizes && ask(VIDIOC_ENUM_FRAMESIZES, &one); ++one.index) {
        if (one.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
            const auto [width, height] = one.discrete;
            modes.push_back({letters_of(format), size_text(width, height), rates_of(ask, format, width, height)});
            continue;
        }
        const auto& range = one.stepwise;
        modes.push_back(
            {letters_of(format),
             size_text(range.min_width, range.min_height) + " to " + size_text(range.max_width, range.max_height),
             rates_of(ask, format, range.max_width, range.max_height)});
        break;
    }
    if (one.index == 0 && (modes.empty() || modes.back().format != letters_of(format)))
        modes.push_back({letters_of(format), "", {}});  // the driver does not enumerate sizes
}

}  // namespace

std::optional<VideoDevice> video_device(const AskDriver& ask)
{
    v4l2_capability about{};
    if (!ask(VIDIOC_QUERYCAP, &about))
        return std::nullopt;
    const bool own = (about.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;  // of this device, and not of the whole camera
    if (((own ? about.device_caps : about.capabilities) & V4L2_CAP_VIDEO_CAPTURE) == 0)
        return std::nullopt;
    VideoDevice device{text_of(about.card), text_of(about.driver), {}};
    v4l2_fmtdesc format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    for (format.index = 0; format.index < most_formats && ask(VIDIOC_ENUM_FMT, &format); ++format.index)
        add_modes(device.modes, ask, format.pixelformat);
    return device;
}

std::string rates_text(const std::vector<double>& rates)
{
    std::string text;
    for (const double rate : rates) {
        std::string number = std::to_string(rate);
        number.erase(number.find_last_not_of('0') + 1);
        if (number.ends_with('.'))
            number.pop_back();
        text += (text.empty() ? "" : " ") + number;
    }
    return text;
}

}  // namespace hivectl
