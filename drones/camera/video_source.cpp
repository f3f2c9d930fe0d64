// Uses VideoCapture, with deadlines where a network is involved and errors that say what is missing.
#include "video_source.hpp"

#include <opencv2/videoio.hpp>

#include <filesystem>
#include <stdexcept>
#include <unistd.h>

namespace camera {
namespace {

/// OpenCV waits 30 s by default; these count only when they are given to open().
const std::vector<int> two_seconds{cv::CAP_PROP_OPEN_TIMEOUT_MSEC, 2000, cv::CAP_PROP_READ_TIMEOUT_MSEC, 2000};

class VideoSource : public Source {
public:
    enum class AtEnd { stop, begin_again };

    VideoSource(cv::VideoCapture capture, AtEnd at_end, cv::MatAllocator* memory)
        : capture_(std::move(capture)), at_end_(at_end), memory_(memory)
    {
    }

    std::optional<Frame> next() override
    {
        Frame frame;
        frame.image.allocator = memory_;
        if (!capture_.read(frame.image) && !(begin_again() && capture_.read(frame.image)))
            return std::nullopt;
        frame.captured = std::chrono::system_clock::now();
        if (!frame.image.u || frame.image.u->refcount > 1)
            frame.image = copied(frame.image);  // the capture has given its own buffer, which it will use again
        frame.index = index_++;
        return frame;
    }

    [[nodiscard]] double fps() const override { return capture_.get(cv::CAP_PROP_FPS); }

private:
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
        index_ = 0;
        return capture_.set(cv::CAP_PROP_POS_FRAMES, 0);
    }

    cv::VideoCapture capture_;
    AtEnd at_end_;
    cv::MatAllocator* memory_;
    std::int64_t index_ = 0;
};

}  // namespace

std::unique_ptr<Source> open_video(const std::string& path, bool loop, cv::MatAllocator* memory)
{
    cv::VideoCapture capture;
    if (!capture.open(std::filesystem::absolute(path).string(), cv::CAP_FFMPEG))
        throw std::runtime_error(path + " is not a video that can be read (damaged, or OpenCV without FFmpeg)");
    return std::make_unique<VideoSource>(std::move(capture),
                                         loop ? VideoSource::AtEnd::begin_again : VideoSource::AtEnd::stop, memory);
}

std::unique_ptr<Source> open_device(const std::string& path, cv::Size size, double fps, cv::MatAllocator* memory)
{
    if (access(path.c_str(), R_OK | W_OK) != 0)
        throw std::runtime_error("cannot use " + path + ": not there, or you are not in the group `video`");
    cv::VideoCapture capture;
    if (!capture.open(path, cv::CAP_V4L2))
        throw std::runtime_error(path + " does not open: in use, or not a camera");
    capture.set(cv::CAP_PROP_FRAME_WIDTH, size.width);
    capture.set(cv::CAP_PROP_FRAME_HEIGHT, size.height);
    if (fps > 0)
        capture.set(cv::CAP_PROP_FPS, fps);
    return std::make_unique<VideoSource>(std::move(capture), VideoSource::AtEnd::stop, memory);
}

std::unique_ptr<Source> open_url(const std::string& url, cv::MatAllocator* memory)
{
    cv::VideoCapture capture;
    if (!capture.open(url, cv::CAP_FFMPEG, two_seconds))
        throw std::runtime_error("no video from " + shown_source(url) + " within 2 s");
    return std::make_unique<VideoSource>(std::move(capture), VideoSource::AtEnd::stop, memory);
}

}  // namespace camera
