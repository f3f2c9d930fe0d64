// Network cameras, read with FFmpeg's libraries: every wait has a deadline, and what goes wrong has its name.
#include "video_source.hpp"

#include <ffmpeg.hpp>

#include <chrono>
#include <optional>
#include <utility>

namespace camera {
namespace {

using Clock = std::chrono::steady_clock;
using ffmpeg::checked;

constexpr std::chrono::seconds to_open{20};  ///< a stream of one picture in 3 s needs as long
constexpr std::chrono::seconds for_a_picture{10};

/// For the place of a URL where the login stands (RFC 3986, section 3.2.1).
std::string encoded(const std::string& text)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string result;
    for (const unsigned char c : text)
        if (std::isalnum(c) || std::string_view("-._~").find(static_cast<char>(c)) != std::string_view::npos)
            result += static_cast<char>(c);
        else
            ((result += '%') += digits[c >> 4]) += digits[c & 15];
    return result;
}

std::string with_login(const std::string& url, const std::optional<capture::Credentials>& login)
{
    if (!login)
        return url;
    const auto host = url.find("://") + 3;
    return url.substr(0, host) + encoded(login->user) + ":" + encoded(login->password) + "@" + url.substr(host);
}

/// One connection to a camera.
class UrlSource : public Source {
public:
    UrlSource(const UrlSettings& settings, cv::MatAllocator* memory) : settings_(settings), memory_(memory)
    {
        av_log_set_level(AV_LOG_QUIET);  // what matters is thrown, and nothing may name the login
        connect();
        open_decoder();
    }

    std::optional<Frame> next() override
    {
        deadline_ = Clock::now() + for_a_picture;
        while (avcodec_receive_frame(decoder_.get(), frame_.get()) < 0)
            if (!feed())
                return std::nullopt;
        Frame result;
        result.image = picture();
        result.captured = std::chrono::system_clock::now();
        result.index = index_++;
        return result;
    }

private:
    /// Without the probing by which FFmpeg guesses at the rate, a slow stream would be looked at for many seconds.
    void connect()
    {
        deadline_ = Clock::now() + to_open;
        AVFormatContext* context = avformat_alloc_context();
        context->interrupt_callback = {[](void* self) { return static_cast<UrlSource*>(self)->late() ? 1 : 0; }, this};
        AVDictionary* options = nullptr;
        av_dict_set(&options, "rtsp_transport", settings_.transport.c_str(), 0);
        av_dict_set(&options, "fpsprobesize", "0", 0);
        av_dict_set(&options, "analyzeduration", "500000", 0);
        const auto url = with_login(settings_.url, settings_.login);
        const int code = avformat_open_input(&context, url.c_str(), nullptr, &options);
        av_dict_free(&options);
        require(code);
        input_.reset(context);
        require(avformat_find_stream_info(input_.get(), nullptr));
    }

    void open_decoder()
    {
        const AVCodec* codec = nullptr;
        stream_ = av_find_best_stream(input_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
        if (stream_ < 0 || !codec)
            throw std::runtime_error(shown() + ": there is no video in it that can be decoded");
        decoder_.reset(avcodec_alloc_context3(codec));
        require(avcodec_parameters_to_context(decoder_.get(), input_->streams[stream_]->codecpar));
        decoder_->thread_count = 1;  // further threads keep a picture each
        decoder_->flags |= AV_CODEC_FLAG_LOW_DELAY;
        require(avcodec_open2(decoder_.get(), codec, nullptr));
    }

    /// The next packet goes to the decoder; false at the end. One that is damaged is passed over.
    bool feed()
    {
        const int code = av_read_frame(input_.get(), packet_.get());
        if (code == AVERROR_EOF)
            return false;
        require(code);
        if (packet_->stream_index == stream_)
            avcodec_send_packet(decoder_.get(), packet_.get());
        av_packet_unref(packet_.get());
        return true;
    }

    [[nodiscard]] cv::Mat picture()
    {
        cv::Mat result;
        result.allocator = memory_;
        result.create(frame_->height, frame_->width, CV_8UC3);
        scaler_.reset(sws_getCachedContext(scaler_.release(), frame_->width, frame_->height,
                                           static_cast<AVPixelFormat>(frame_->format), frame_->width, frame_->height,
                                           AV_PIX_FMT_BGR24, SWS_BICUBIC, nullptr, nullptr, nullptr));
        if (!scaler_)
            throw std::runtime_error(shown() + ": its pictures cannot be converted");
        std::uint8_t* const rows[] = {result.data};
        const int strides[] = {static_cast<int>(result.step)};
        sws_scale(scaler_.get(), frame_->data, frame_->linesize, 0, frame_->height, rows, strides);
        return result;
    }

    [[nodiscard]] bool late() const { return Clock::now() >= deadline_; }
    [[nodiscard]] std::string shown() const { return shown_source(settings_.url); }
    void require(int code) const
    {
        if (code < 0 && late())
            throw std::runtime_error(shown() + ": " + (decoder_ ? "no picture for 10 s" : "no video within 20 s"));
        const bool refused = code == AVERROR_HTTP_UNAUTHORIZED || code == AVERROR_HTTP_FORBIDDEN;
        if (refused && settings_.login)
            throw LoginRefused(shown() + ": the camera refuses this login");
        if (refused)
            throw std::runtime_error(shown() + ": the camera wants a login; set credentials=FILE");
        checked(code, shown());
    }

    UrlSettings settings_;
    cv::MatAllocator* memory_;
    Clock::time_point deadline_{};
    ffmpeg::Input input_;
    ffmpeg::CodecContext decoder_;
    ffmpeg::FramePtr frame_{av_frame_alloc()};
    ffmpeg::PacketPtr packet_{av_packet_alloc()};
    ffmpeg::Scaler scaler_;
    int stream_ = -1;
    std::int64_t index_ = 0;
};

}  // namespace

std::unique_ptr<Source> open_url(const UrlSettings& settings, cv::MatAllocator* memory)
{
    return std::make_unique<UrlSource>(settings, memory);
}

}  // namespace camera
