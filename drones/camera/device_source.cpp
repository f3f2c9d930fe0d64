// Cameras of Video4Linux, read by OpenCV's VideoCapture.
#include "video_source.hpp"

#include <opencv2/videoio.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unistd.h>
#include <utility>

namespace camera {
namespace {

class DeviceSource : public Source {
public:
    /// The mode that the device reports, and a sentence if it is not the requested one.
    DeviceSource(cv::VideoCapture capture, cv::MatAllocator* memory, const DeviceForm& form,
                 const std::string& sentence)
        : capture_(std::move(capture)), memory_(memory), device_(to_text(form)), fps_(form.fps)
    {
        if (!sentence.empty())
            tell(sentence);
    }

    std::optional<Frame> next() override
    {
        Frame frame;
        frame.image.allocator = memory_;
        if (!capture_.read(frame.image))
            return std::nullopt;
        frame.captured = std::chrono::system_clock::now();
        frame.device = device_;
        frame.fps = fps_;
        if (!frame.image.u || frame.image.u->refcount > 1)
            frame.image = copied(frame.image);  // the capture returns its own buffer, which it will reuse
        frame.index = index_++;
        return frame;
    }

    [[nodiscard]] double fps() const override { return capture_.get(cv::CAP_PROP_FPS); }

private:
    [[nodiscard]] cv::Mat copied(const cv::Mat& image) const
    {
        cv::Mat copy;
        copy.allocator = memory_;
        image.copyTo(copy);
        return copy;
    }

    cv::VideoCapture capture_;
    cv::MatAllocator* memory_;
    std::string device_;
    double fps_;
    std::int64_t index_ = 0;
};

int code_of(const std::string& format)
{
    const auto letter = [&](std::size_t i) { return i < format.size() ? format[i] : ' '; };
    return cv::VideoWriter::fourcc(letter(0), letter(1), letter(2), letter(3));
}

std::string letters_of(int code)
{
    std::string letters;
    for (int shift = 0; shift < 32; shift += 8)
        if (const auto letter = static_cast<char>(code >> shift & 0x7F); letter > ' ' && letter < 0x7F)
            letters += letter;
    return letters;
}

/// In the order that drivers require: the sizes depend on the format, the rates on both.
void ask(cv::VideoCapture& device, const DeviceForm& asked)
{
    if (!asked.format.empty())
        device.set(cv::CAP_PROP_FOURCC, code_of(asked.format));
    device.set(cv::CAP_PROP_FRAME_WIDTH, asked.size.width);
    device.set(cv::CAP_PROP_FRAME_HEIGHT, asked.size.height);
    if (asked.fps > 0)
        device.set(cv::CAP_PROP_FPS, asked.fps);
}

DeviceForm form_of(const cv::VideoCapture& device)
{
    return {letters_of(static_cast<int>(device.get(cv::CAP_PROP_FOURCC))),
            {static_cast<int>(device.get(cv::CAP_PROP_FRAME_WIDTH)),
             static_cast<int>(device.get(cv::CAP_PROP_FRAME_HEIGHT))},
            std::max(0.0, device.get(cv::CAP_PROP_FPS))};
}

}  // namespace

std::string to_text(const DeviceForm& form)
{
    std::string text = form.format;
    if (!form.size.empty())
        text += (text.empty() ? "" : " ") + std::to_string(form.size.width) + "x" + std::to_string(form.size.height);
    if (form.fps > 0)
        text += (text.empty() ? "at " : " at ") + std::to_string(std::lround(form.fps)) + " fps";
    return text;
}

bool fits(const DeviceForm& asked, const DeviceForm& got)
{
    return (asked.format.empty() || asked.format == got.format) && (asked.size.empty() || asked.size == got.size)
           && (asked.fps <= 0 || got.fps <= 0 || std::abs(asked.fps - got.fps) <= 0.05 * asked.fps);
}

std::unique_ptr<Source> open_device(const std::string& path, const DeviceForm& asked, cv::MatAllocator* memory)
{
    if (access(path.c_str(), R_OK | W_OK) != 0)
        throw std::runtime_error("cannot use " + path + ": not there, or you are not in the group `video`");
    cv::VideoCapture capture;
    if (!capture.open(path, cv::CAP_V4L2))
        throw std::runtime_error(path + " does not open: in use, or not a camera");
    ask(capture, asked);
    const auto got = form_of(capture);
    return std::make_unique<DeviceSource>(std::move(capture), memory, got,
                                          fits(asked, got) ? ""
                                                           : path + ": asked for " + to_text(asked) + ", it gives "
                                                                 + to_text(got) + "; see its modes: hivectl devices");
}

}  // namespace camera
