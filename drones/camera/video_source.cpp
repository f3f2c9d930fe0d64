// Video files, once or in a loop.
#include "video_source.hpp"

#include "frame_converter.hpp"
#include "video_input.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace camera {
namespace {

class VideoSource : public Source {
public:
    VideoSource(std::string path, bool loop, cv::MatAllocator* memory)
        : path_(std::move(path)), loop_(loop), input_(std::make_unique<VideoInput>(path_)), converter_(memory)
    {
    }

    std::optional<Frame> next() override
    {
        const AVFrame* decoded = input_->next();
        Frame frame;
        if (!decoded && loop_ && index_ > 0) {
            begin_again();
            frame.restarts = true;
            decoded = input_->next();
        }
        ended_ = !decoded;
        if (!decoded)
            return std::nullopt;
        frame.image = converter_.image(*decoded, input_->quarter_turns());
        frame.captured = std::chrono::system_clock::now();
        frame.file = path_;
        frame.fps = input_->fps();
        frame.media_time = time();
        frame.index = index_++;
        return frame;
    }

    [[nodiscard]] double fps() const override { return input_->fps(); }
    [[nodiscard]] std::int64_t count() const override { return loop_ ? 0 : ended_ ? index_ : input_->frames(); }
    [[nodiscard]] std::string cut_short() const override { return input_->shortfall(); }

private:
    /// Reopens the file, because not every format is seekable. If the file is gone, this round stays at its end.
    void begin_again()
    {
        if (const auto problem = cut_short(); !problem.empty() && !std::exchange(reported_, true))
            tell(problem);
        input_ = std::make_unique<VideoInput>(path_);
        index_ = 0;
    }

    /// The presentation time. If the file has none, or it does not increase, frames are counted.
    std::chrono::microseconds time()
    {
        const double fps = input_->fps();
        const std::chrono::microseconds counted(fps > 0 ? std::llround(static_cast<double>(index_) / fps * 1e6)
                                                        : std::int64_t{0});
        const auto presented = input_->time();
        const bool continues = presented && (index_ == 0 ? presented->count() >= 0 : *presented > last_);
        last_ = continues ? *presented : index_ == 0 ? counted : std::max(counted, last_);
        return last_;
    }

    std::string path_;
    bool loop_;
    std::unique_ptr<VideoInput> input_;
    FrameConverter converter_;
    std::int64_t index_ = 0;
    std::chrono::microseconds last_{0};
    bool reported_ = false, ended_ = false;
};

}  // namespace

std::unique_ptr<Source> open_video(const std::string& path, bool loop, cv::MatAllocator* memory)
{
    return std::make_unique<VideoSource>(path, loop, memory);
}

}  // namespace camera
