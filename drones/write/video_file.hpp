// A video file in which each image keeps its time, and which is playable when truncated.
#pragma once

#include "sink.hpp"
#include "video_encoder.hpp"

#include <optional>

namespace writing {

/// While it is being written, an .mp4 consists of complete fragments of about a second; on closing it is rewritten
/// without them. An .avi has a constant rate, to which times are rounded.
class VideoFile final : public Sink {
public:
    explicit VideoFile(Settings settings);
    ~VideoFile() override;

    void add(const Image& image, std::chrono::microseconds time) override;
    void close() override;
    [[nodiscard]] bool takes_encoded(const std::string&) const override { return false; }
    [[nodiscard]] std::optional<Held> held() const override;
    [[nodiscard]] std::string encoder() const override { return encoder_ ? encoder_->name() : ""; }

    /// Is this the extension of a video?
    static bool knows(const std::string& path);

private:
    void begin(const Image& image);
    void write(AVPacket& packet);
    void abandon();

    Settings settings_;
    AVFormatContext* file_ = nullptr;
    bool started_ = false;  ///< with a header and an encoder: only then it can be completed
    AVStream* stream_ = nullptr;
    std::optional<VideoEncoder> encoder_;
    std::optional<std::int64_t> last_, last_key_;  ///< times of images, in the time base of the encoder
    std::int64_t distance_ = 0;
};

}  // namespace writing
