// A video file in which each image keeps its time, and which can be played whenever it is cut off.
#pragma once

#include "sink.hpp"
#include "video_encoder.hpp"

#include <optional>

namespace writing {

/// While it is written an .mp4 consists of fragments of about a second, each complete in itself; when it is closed it
/// becomes one whole. An .avi has a constant rate by its nature: times are rounded to that.
class VideoFile final : public Sink {
public:
    explicit VideoFile(Settings settings);
    ~VideoFile() override;

    void add(const Picture& picture, std::chrono::microseconds time) override;
    void close() override;
    [[nodiscard]] bool takes_encoded(const std::string&) const override { return false; }
    [[nodiscard]] std::optional<Held> held() const override;
    [[nodiscard]] std::string encoder() const override { return encoder_ ? encoder_->name() : ""; }

    /// Is that the ending of a video?
    static bool knows(const std::string& path);

private:
    void begin(const Picture& picture);
    void write(AVPacket& packet);
    void abandon();

    Settings settings_;
    AVFormatContext* file_ = nullptr;
    bool begun_ = false;  ///< with a header and an encoder: only what has begun can be completed
    AVStream* stream_ = nullptr;
    std::optional<VideoEncoder> encoder_;
    std::optional<std::int64_t> last_, last_key_;  ///< times of images, in the time base of the encoder
    std::int64_t distance_ = 0;
};

}  // namespace writing
