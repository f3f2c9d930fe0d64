// Uses VideoCapture, with errors that say what is missing.
#include "video_source.hpp"

#include <opencv2/videoio.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <unistd.h>

namespace camera {
namespace {

class VideoSource : public Source {
public:
    enum class AtEnd { stop, begin_again };

    /// @param file  empty: no file
    VideoSource(cv::VideoCapture capture, AtEnd at_end, cv::MatAllocator* memory, std::string file = "")
        : capture_(std::move(capture)), at_end_(at_end), memory_(memory), file_(std::move(file))
    {
    }

    std::optional<Frame> next() override
    {
        Frame frame;
        frame.image.allocator = memory_;
        if (!capture_.read(frame.image)) {
            if (!begin_again() || !capture_.read(frame.image))
                return std::nullopt;
            frame.begins_again = true;
        }
        frame.captured = std::chrono::system_clock::now();
        note_file(frame);
        note_device(frame);
        if (!frame.image.u || frame.image.u->refcount > 1)
            frame.image = copied(frame.image);  // the capture has given its own buffer, which it will use again
        frame.index = index_++;
        return frame;
    }

    /// The device gives this, and that is not as it should be if there is a sentence about it.
    void device(const DeviceForm& form, const std::string& sentence)
    {
        device_ = to_text(form);
        device_fps_ = form.fps;
        if (!sentence.empty())
            tell(sentence);
    }

    [[nodiscard]] double fps() const override { return capture_.get(cv::CAP_PROP_FPS); }

    [[nodiscard]] std::int64_t count() const override
    {
        return file_.empty() || at_end_ == AtEnd::begin_again ? 0 : frames();
    }

    /// Where the container says only how long it lasts, the number of pictures is an estimate, and not held against it.
    [[nodiscard]] std::string cut_short() const override
    {
        const auto promised = frames();
        if (file_.empty() || index_ + std::max<std::int64_t>(1, promised / 50) >= promised)
            return "";
        return file_ + ": " + std::to_string(index_) + " of " + std::to_string(promised)
               + " frames: the file is damaged or was cut short";
    }

private:
    /// As the file says, or as OpenCV concludes from how long it lasts.
    [[nodiscard]] std::int64_t frames() const
    {
        return std::max<std::int64_t>(0, static_cast<std::int64_t>(capture_.get(cv::CAP_PROP_FRAME_COUNT)));
    }
    [[nodiscard]] cv::Mat copied(const cv::Mat& picture) const
    {
        cv::Mat copy;
        copy.allocator = memory_;
        picture.copyTo(copy);
        return copy;
    }
    bool begin_again()
    {
        if (at_end_ == AtEnd::stop || index_ == 0)
            return false;
        if (const auto problem = cut_short(); !problem.empty() && !std::exchange(told_, true))
            tell(problem);
        index_ = 0;
        return capture_.set(cv::CAP_PROP_POS_FRAMES, 0);
    }
    void note_device(Frame& frame) const
    {
        if (device_.empty())
            return;
        frame.device = device_;
        frame.fps = device_fps_;
    }
    /// The time of a picture is that of its presentation. Where the file does not tell it, pictures are counted.
    void note_file(Frame& frame)
    {
        if (file_.empty())
            return;
        frame.file = file_;
        frame.fps = fps();
        const auto told = static_cast<std::int64_t>(std::llround(capture_.get(cv::CAP_PROP_POS_MSEC) * 1000));
        const auto counted = frame.fps > 0 ? std::llround(static_cast<double>(index_) / frame.fps * 1e6) : 0;
        const bool goes_on = index_ == 0 ? told >= 0 : told > last_us_;
        last_us_ = goes_on ? told : std::max<std::int64_t>(counted, index_ == 0 ? 0 : last_us_);
        frame.media_time = std::chrono::microseconds(last_us_);
    }

    cv::VideoCapture capture_;
    AtEnd at_end_;
    cv::MatAllocator* memory_;
    std::string file_;
    std::int64_t index_ = 0, last_us_ = 0;
    bool told_ = false;
    std::string device_;  ///< empty: no device
    double device_fps_ = 0;
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

/// In the order that drivers want: the sizes depend on the format, the rates on both.
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

std::unique_ptr<Source> open_video(const std::string& path, bool loop, cv::MatAllocator* memory)
{
    cv::VideoCapture capture;
    if (!capture.open(std::filesystem::absolute(path).string(), cv::CAP_FFMPEG))
        throw std::runtime_error(path + " is not a video that can be read (damaged, or OpenCV without FFmpeg)");
    return std::make_unique<VideoSource>(
        std::move(capture), loop ? VideoSource::AtEnd::begin_again : VideoSource::AtEnd::stop, memory, path);
}

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
    auto source = std::make_unique<VideoSource>(std::move(capture), VideoSource::AtEnd::stop, memory);
    source->device(got, fits(asked, got) ? ""
                                         : path + ": asked for " + to_text(asked) + ", it gives " + to_text(got)
                                               + "; see what it can: hivectl devices");
    return source;
}

}  // namespace camera
