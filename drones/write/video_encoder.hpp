// Encodes images with the first available encoder of FFmpeg that the file supports.
#pragma once

#include <ffmpeg.hpp>

#include <opencv2/core/mat.hpp>

#include <functional>
#include <string>

namespace writing {

struct EncoderSettings {
    cv::Size size;
    AVRational time_base{1, 60'000};
    AVRational frame_rate{30, 1};  ///< the usual rate, for encoders that need one
    int quality = 80;              ///< 1 to 100
};

/// For one thread. Encodes without delay, so that a truncated file has all images.
class VideoEncoder {
public:
    /// @param container  the destination of the packets
    /// @throws std::runtime_error  no encoder fits
    VideoEncoder(const AVOutputFormat& container, const EncoderSettings& settings);

    /// @param image  BGR or grey, 8 bit, of any size: it is scaled
    /// @param key      encode it as a key frame
    void encode(const cv::Mat& image, std::int64_t time, bool key, const std::function<void(AVPacket&)>& take);
    /// Flushes the encoder.
    void finish(const std::function<void(AVPacket&)>& take);

    [[nodiscard]] const AVCodecContext& context() const { return *context_; }
    [[nodiscard]] std::string name() const { return context_->codec->name; }

private:
    bool open(const AVCodec& codec, const AVOutputFormat& container, const EncoderSettings& settings);
    void receive(const std::function<void(AVPacket&)>& take);

    ffmpeg::CodecContext context_;
    ffmpeg::FramePtr frame_;
    ffmpeg::PacketPtr packet_;
    ffmpeg::Scaler scaler_;
};

}  // namespace writing
