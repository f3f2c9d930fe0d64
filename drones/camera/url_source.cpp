// Network cameras, decoded with FFmpeg's libraries.
#include "frame_converter.hpp"
#include "url_input.hpp"

#include <utility>

namespace camera {
namespace {

/// One connection to a camera.
class UrlSource : public Source {
public:
    UrlSource(const UrlSettings& settings, cv::MatAllocator* memory)
        : max_pixels_(settings.limits.pixels), input_(settings), converter_(memory)
    {
        if (!feed())
            throw std::runtime_error(input_.shown() + ": it contains no decodable video");
    }

    std::optional<Frame> next() override
    {
        constexpr std::chrono::seconds frame_timeout{10};
        input_.expect_until(UrlInput::Clock::now() + frame_timeout, "no image for 10 s");
        while (avcodec_receive_frame(decoder_.get(), frame_.get()) < 0)
            if (!feed())
                return std::nullopt;
        Frame result;
        result.image = converter_.image(*frame_);
        result.captured = std::chrono::system_clock::now();
        result.fps = fps();
        result.index = index_++;
        return result;
    }

    /// From the stream's own header or its description; 0 for a rate that no camera has.
    [[nodiscard]] double fps() const override
    {
        for (const double fps : {av_q2d(decoder_->framerate), input_.described_fps()})
            if (fps >= 0.01 && fps <= 1000)
                return fps;
        return 0;
    }

private:
    /// Decodes from the first packet on: FFmpeg's own probing decodes without a limit of pixels.
    void open_decoder()
    {
        const AVCodecParameters* parameters = input_.video()->codecpar;
        const AVCodec* codec = avcodec_find_decoder(parameters->codec_id);
        decoder_.reset(avcodec_alloc_context3(codec));
        ffmpeg::checked(avcodec_parameters_to_context(decoder_.get(), parameters), input_.shown());
        decoder_->max_pixels = max_pixels_;
        decoder_->thread_count = 1;  // further threads keep an image each
        decoder_->flags |= AV_CODEC_FLAG_LOW_DELAY;
        ffmpeg::checked(avcodec_open2(decoder_.get(), codec, nullptr), input_.shown());
    }

    /// Passes the next packet to the decoder; false at the end. Skips damaged ones.
    bool feed()
    {
        if (!input_.read(*packet_))
            return false;
        if (!decoder_)
            open_decoder();
        input_.decode(*decoder_, *packet_);
        av_packet_unref(packet_.get());
        return true;
    }

    std::int64_t max_pixels_;
    UrlInput input_;
    ffmpeg::CodecContext decoder_;
    ffmpeg::FramePtr frame_{av_frame_alloc()};
    ffmpeg::PacketPtr packet_{av_packet_alloc()};
    FrameConverter converter_;
    std::int64_t index_ = 0;
};

}  // namespace

std::unique_ptr<Source> open_url(const UrlSettings& settings, cv::MatAllocator* memory)
{
    return std::make_unique<UrlSource>(settings, memory);
}

}  // namespace camera
