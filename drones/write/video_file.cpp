// Muxing with libavformat.
#include "video_file.hpp"

#include "regular_file.hpp"

#include <algorithm>
#include <filesystem>

namespace writing {
namespace {

namespace fs = std::filesystem;
using ffmpeg::checked;

std::string extension_of(const std::string& path)
{
    std::string extension = fs::path(path).extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

bool is_mp4(const std::string& path)
{
    const auto extension = extension_of(path);
    return extension == ".mp4" || extension == ".m4v" || extension == ".mov";
}

/// Bypasses FFmpeg's own parsing of the path, which may have a colon or `%d`.
std::string url_of(const std::string& path) { return "file:" + fs::absolute(path).string(); }

void open_to_write(AVIOContext*& opened, const std::string& path)
{
    require_regular_or_missing(path);
    checked(avio_open(&opened, url_of(path).c_str(), AVIO_FLAG_WRITE), path);
}

cv::Mat eight_bits(const cv::Mat& image)
{
    if (image.depth() != CV_16U)
        return image;
    cv::Mat result;
    image.convertTo(result, CV_8U, 1.0 / 257);
    return result;
}

/// Copies the packets of a fragmented file into one with an index.
class Remuxing {
public:
    Remuxing(const std::string& from, const std::string& to)
    {
        checked(avformat_open_input(&in_, url_of(from).c_str(), nullptr, nullptr), from);
        checked(avformat_find_stream_info(in_, nullptr), from);
        checked(avformat_alloc_output_context2(&out_, nullptr, "mp4", url_of(to).c_str()), to);
        AVStream* stream = avformat_new_stream(out_, nullptr);
        checked(avcodec_parameters_copy(stream->codecpar, in_->streams[0]->codecpar), to);
        stream->codecpar->codec_tag = 0;
        stream->time_base = in_->streams[0]->time_base;
        open_to_write(out_->pb, to);
    }
    ~Remuxing()
    {
        avformat_close_input(&in_);
        if (out_)
            avio_closep(&out_->pb);
        avformat_free_context(out_);
    }
    Remuxing(const Remuxing&) = delete;
    Remuxing& operator=(const Remuxing&) = delete;

    void run()
    {
        const ffmpeg::PacketPtr packet(av_packet_alloc());
        checked(avformat_write_header(out_, nullptr), "the file could not be completed");
        while (av_read_frame(in_, packet.get()) >= 0) {
            av_packet_rescale_ts(packet.get(), in_->streams[0]->time_base, out_->streams[0]->time_base);
            packet->pos = -1;
            checked(av_interleaved_write_frame(out_, packet.get()), "the file could not be completed");
        }
        checked(av_write_trailer(out_), "the file could not be completed");
        checked(avio_closep(&out_->pb), "the file could not be completed");
    }

private:
    AVFormatContext *in_ = nullptr, *out_ = nullptr;
};

/// If that fails, for example on a full disk, the fragments stay: they are the same video.
void make_whole(const std::string& path)
{
    const std::string part = path + ".whole";
    std::error_code ignored;
    try {
        Remuxing(path, part).run();
        fs::rename(part, path);
    } catch (const std::exception&) {
        fs::remove(part, ignored);
    }
}

}  // namespace

VideoFile::VideoFile(Settings settings) : settings_(std::move(settings)) {}

VideoFile::~VideoFile() { abandon(); }

bool VideoFile::knows(const std::string& path)
{
    const auto extension = extension_of(path);
    return is_mp4(path) || extension == ".mkv" || extension == ".avi";
}

void VideoFile::begin(const Image& image)
{
    const bool avi = extension_of(settings_.path) == ".avi";
    const double fps = image.fps > 0 ? std::clamp(image.fps, 0.1, 1000.0) : 30;
    EncoderSettings encoding{.size = image.pixels.size(), .quality = settings_.quality};
    encoding.frame_rate = av_d2q(fps, 60'000);
    if (avi)
        encoding.time_base = av_inv_q(encoding.frame_rate);
    checked(avformat_alloc_output_context2(&file_, nullptr, is_mp4(settings_.path) ? "mp4" : nullptr,
                                           url_of(settings_.path).c_str()),
            settings_.path);
    encoder_.emplace(*file_->oformat, encoding);
    stream_ = avformat_new_stream(file_, nullptr);
    stream_->time_base = encoding.time_base;
    stream_->avg_frame_rate = encoding.frame_rate;
    checked(avcodec_parameters_from_context(stream_->codecpar, &encoder_->context()), settings_.path);
    file_->flags |= AVFMT_FLAG_FLUSH_PACKETS;
    open_to_write(file_->pb, settings_.path);
    AVDictionary* options = nullptr;
    if (is_mp4(settings_.path))
        av_dict_set(&options, "movflags", "frag_keyframe+empty_moov+default_base_moof", 0);
    const int code = avformat_write_header(file_, &options);
    av_dict_free(&options);
    checked(code, settings_.path);
    started_ = true;
}

void VideoFile::add(const Image& image, std::chrono::microseconds time)
{
    if (!file_)
        begin(image);
    const AVRational base = encoder_->context().time_base;
    auto at = av_rescale_q(time.count(), {1, 1'000'000}, base);
    if (last_) {
        at = std::max(at, *last_ + 1);
        distance_ = at - *last_;
    } else {
        distance_ = std::max<std::int64_t>(1, av_rescale_q(1, av_inv_q(encoder_->context().framerate), base));
    }
    last_ = at;
    const auto second = av_rescale_q(1, {1, 1}, base);
    const bool key = !last_key_ || at - *last_key_ >= second;
    if (key)
        last_key_ = at;
    encoder_->encode(eight_bits(image.pixels), at, key, [this](AVPacket& packet) { write(packet); });
}

void VideoFile::write(AVPacket& packet)
{
    packet.stream_index = stream_->index;
    packet.duration = distance_;
    av_packet_rescale_ts(&packet, encoder_->context().time_base, stream_->time_base);
    checked(av_write_frame(file_, &packet), settings_.path);
    checked(file_->pb->error, settings_.path);
}

void VideoFile::close()
{
    if (!started_)
        return abandon();
    try {
        encoder_->finish([this](AVPacket& packet) { write(packet); });
        checked(av_write_trailer(file_), settings_.path);
        checked(avio_closep(&file_->pb), settings_.path);
    } catch (...) {
        abandon();
        throw;
    }
    abandon();
    if (is_mp4(settings_.path))
        make_whole(settings_.path);
}

std::optional<Held> VideoFile::held() const
{
    Held held;
    AVFormatContext* context = nullptr;
    if (avformat_open_input(&context, url_of(settings_.path).c_str(), nullptr, nullptr) < 0)
        return held;
    const ffmpeg::Input file(context);
    const ffmpeg::PacketPtr packet(av_packet_alloc());
    for (; av_read_frame(file.get(), packet.get()) >= 0; av_packet_unref(packet.get())) {
        if ((packet->flags & AV_PKT_FLAG_CORRUPT) != 0)
            continue;
        ++held.images;
        held.last =
            std::chrono::microseconds(av_rescale_q(packet->pts == AV_NOPTS_VALUE ? packet->dts : packet->pts,
                                                   file->streams[packet->stream_index]->time_base, {1, 1'000'000}));
    }
    return held;
}

/// Leaves the written part unchanged.
void VideoFile::abandon()
{
    if (file_ && file_->pb)
        avio_closep(&file_->pb);
    avformat_free_context(file_);
    file_ = nullptr;
    started_ = false;
}

}  // namespace writing
