// Interrupts FFmpeg at limits that FFmpeg itself does not have.
#include "url_input.hpp"

#include "url_options.hpp"

#include <shown_url.hpp>

#include <cstdlib>
#include <utility>

namespace camera {
namespace {

/// Coded data have no such marker in them.
std::ptrdiff_t scans_of(const AVPacket& jpeg)
{
    constexpr std::string_view start_of_scan = "\xFF\xDA";
    const std::string_view bytes(reinterpret_cast<const char*>(jpeg.data), static_cast<std::size_t>(jpeg.size));
    std::ptrdiff_t count = 0;
    for (auto at = bytes.find(start_of_scan); at != std::string_view::npos; at = bytes.find(start_of_scan, at + 2))
        ++count;
    return count;
}

std::string mebibytes(std::int64_t bytes) { return std::to_string(bytes >> 20) + " MiB"; }

}  // namespace

UrlInput::UrlInput(const UrlSettings& settings)
    : settings_(settings), rtsp_(settings.url.starts_with("rtsp")), guard_(reply_rules(settings))
{
    av_max_alloc(static_cast<std::size_t>(rtsp_ ? settings.limits.rtsp_allocation : settings.limits.allocation));
    connect();
}

std::string UrlInput::shown() const { return shown_source(settings_.url); }

void UrlInput::expect_until(Clock::time_point deadline, const char* otherwise)
{
    deadline_ = deadline;
    otherwise_ = otherwise;
}

void UrlInput::connect()
{
    constexpr std::chrono::seconds to_open{20};  // a stream of one image in 3 s needs as long
    expect_until(Clock::now() + to_open, "no video within 20 s");
    const FfmpegLogWatch watch(*this);
    context_ = avformat_alloc_context();
    context_->interrupt_callback = {[](void* self) { return static_cast<UrlInput*>(self)->interrupted() ? 1 : 0; },
                                    this};
    context_->opaque = this;
    default_open_ = std::exchange(context_->io_open, &UrlInput::open_io);
    AVDictionary* options = url_options(settings_);
    const auto url = with_login(settings_);
    const int code =
        avformat_open_input(&context_, url.c_str(), rtsp_ ? av_find_input_format("rtsp") : nullptr, &options);
    av_dict_free(&options);
    input_.reset(context_);
    require(code);
}

/// The first address is the given one; others would be from the stream.
int UrlInput::open_io(AVFormatContext* context, AVIOContext** io, const char* url, int flags, AVDictionary** options)
{
    auto& self = *static_cast<UrlInput*>(context->opaque);
    if (context->pb == nullptr && url == std::string_view(with_login(self.settings_)))
        return self.default_open_(context, io, url, flags, options);
    self.guard_.refuse("its stream names another address, " + capture::shown_url(url) + ", which is not opened");
    return AVERROR(EACCES);
}

/// No second connection: FFmpeg follows redirections of RTSP without an end.
void UrlInput::reply_line(std::string_view line)
{
    if (rtsp_ && !settings_.limits.redirects)
        av_opt_set(context_, "protocol_whitelist", "udp,rtp", 0);
    replied_ = true;
    guard_.take(line);
}

void UrlInput::description(std::string_view text)
{
    constexpr std::string_view field = "\na=framerate:";
    if (const auto at = text.find(field); at != std::string_view::npos)
        described_fps_ = std::strtod(std::string(text.substr(at + field.size(), 20)).c_str(), nullptr);
}

void UrlInput::refused_pixels(std::int64_t width, std::int64_t height)
{
    if (width * height > settings_.limits.pixels)
        guard_.refuse("an image of " + std::to_string(width) + "x" + std::to_string(height) + " pixels; at most "
                      + std::to_string(settings_.limits.pixels) + " are accepted");
}

void UrlInput::refused_streams()
{
    guard_.refuse("it announces more than " + std::to_string(settings_.limits.streams) + " streams");
}

void UrlInput::refused_format()
{
    guard_.refuse("its format is not that of a camera's stream (playlists are not followed)");
}

void UrlInput::rtp_packet(int bytes) { rtp_bytes_ += bytes; }

std::int64_t UrlInput::bytes_since_packet() const
{
    const bool http = !rtsp_ && context_ != nullptr && context_->pb != nullptr;
    return http ? avio_tell(context_->pb) - http_begin_ : rtp_bytes_;
}

bool UrlInput::interrupted()
{
    if (bytes_since_packet() > settings_.limits.bytes)
        guard_.refuse("more than " + mebibytes(settings_.limits.bytes) + " without an image");
    return Clock::now() >= deadline_ || !guard_.refusal().empty();
}

/// The first packet of video with a supported codec selects the stream.
bool UrlInput::choose(const AVPacket& packet)
{
    const AVCodecParameters& codec = *input_->streams[packet.stream_index]->codecpar;
    if (stream_ < 0 && codec.codec_type == AVMEDIA_TYPE_VIDEO && avcodec_find_decoder(codec.codec_id) != nullptr)
        stream_ = packet.stream_index;
    if (packet.stream_index != stream_)
        input_->streams[packet.stream_index]->discard = AVDISCARD_ALL;
    return packet.stream_index == stream_;
}

bool UrlInput::read(AVPacket& packet)
{
    const FfmpegLogWatch watch(*this);
    for (;; av_packet_unref(&packet)) {
        const int code = av_read_frame(input_.get(), &packet);
        if (code == AVERROR_EOF && guard_.refusal().empty() && Clock::now() < deadline_)
            return false;
        require(code);
        if (packet.size > settings_.limits.bytes)
            throw std::runtime_error(shown() + ": an image of more than " + mebibytes(settings_.limits.bytes));
        if (choose(packet))
            break;
    }
    http_begin_ += rtsp_ ? 0 : bytes_since_packet();
    rtp_bytes_ = 0;
    return true;
}

void UrlInput::decode(AVCodecContext& decoder, const AVPacket& packet)
{
    if (decoder.codec_id == AV_CODEC_ID_MJPEG && scans_of(packet) > settings_.limits.scans)
        throw std::runtime_error(shown() + ": a JPEG of more than " + std::to_string(settings_.limits.scans)
                                 + " scans");
    const FfmpegLogWatch watch(*this);
    avcodec_send_packet(&decoder, &packet);
    require(0);
}

const AVStream* UrlInput::video() const { return stream_ < 0 ? nullptr : input_->streams[stream_]; }

void UrlInput::require(int code) const
{
    if (!guard_.refusal().empty())
        throw std::runtime_error(shown() + ": " + guard_.refusal());
    if (code < 0 && Clock::now() >= deadline_)
        throw std::runtime_error(shown() + ": " + otherwise_);
    if (code == AVERROR(EIO) && !replied_ && settings_.url.starts_with("https"))
        throw std::runtime_error(shown() + ": no encrypted connection: its certificate is not trusted or names another "
                                 + "host; for one that the camera made itself, set certificate=FILE");
    const bool refused = code == AVERROR_HTTP_UNAUTHORIZED || code == AVERROR_HTTP_FORBIDDEN;
    if (refused && settings_.login)
        throw LoginRefused(shown() + ": the camera refuses this login");
    if (refused)
        throw std::runtime_error(shown() + ": login required; set credentials=FILE");
    ffmpeg::checked(code, shown());
}

}  // namespace camera
