// H.264 if there is an encoder for it, otherwise MPEG-4 or Motion JPEG.
#include "video_encoder.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace writing {
namespace {

using ffmpeg::checked;

/// The constant rate factor of x264: 18 at the usual 80, 10 at 100.
std::string rate_factor(int quality) { return std::to_string(std::lround(50 - 0.4 * quality)); }

/// The quantizer of the older encoders, 1 to 31.
int quantizer(int quality) { return std::clamp(static_cast<int>(std::lround(31 - 0.3 * quality)), 1, 31); }

cv::Mat in_colour(const cv::Mat& image)
{
    if (image.channels() == 3)
        return image;
    cv::Mat colour;
    cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
    return colour;
}

/// libswscale, when it scales, reads past the end of the last row.
cv::Mat with_margin(const cv::Mat& colour)
{
    cv::Mat wider;
    cv::copyMakeBorder(colour, wider, 0, 1, 0, 0, cv::BORDER_REPLICATE);
    return wider.rowRange(0, colour.rows);
}

}  // namespace

VideoEncoder::VideoEncoder(const AVOutputFormat& container, const EncoderSettings& settings)
    : frame_(av_frame_alloc()), packet_(av_packet_alloc())
{
    for (const char* name : {"libx264", "libopenh264", "mpeg4", "mjpeg"}) {
        const AVCodec* codec = avcodec_find_encoder_by_name(name);
        if (codec && avformat_query_codec(&container, codec->id, FF_COMPLIANCE_NORMAL) == 1
            && open(*codec, container, settings))
            break;
    }
    if (!context_)
        throw std::runtime_error(std::string("FFmpeg has no encoder for ") + container.long_name);
    frame_->format = context_->pix_fmt;
    frame_->width = context_->width;
    frame_->height = context_->height;
    checked(av_frame_get_buffer(frame_.get(), 0), "no memory for an image");
}

bool VideoEncoder::open(const AVCodec& codec, const AVOutputFormat& container, const EncoderSettings& settings)
{
    ffmpeg::CodecContext context(avcodec_alloc_context3(&codec));
    context->width = (settings.size.width + 1) / 2 * 2;  // colours are kept at half the size
    context->height = (settings.size.height + 1) / 2 * 2;
    context->pix_fmt = codec.id == AV_CODEC_ID_MJPEG ? AV_PIX_FMT_YUVJ420P : AV_PIX_FMT_YUV420P;
    context->time_base = settings.time_base;
    context->framerate = settings.frame_rate;
    context->thread_count = 1;  // one drone, one core
    if (container.flags & AVFMT_GLOBALHEADER)
        context->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    if (codec.id == AV_CODEC_ID_H264) {
        if (std::max(context->width, context->height) > 16'384)
            return false;  // beyond the limit of libx264, which would leak memory when it refuses
        av_opt_set(context->priv_data, "preset", "veryfast", 0);
        av_opt_set(context->priv_data, "tune", "zerolatency", 0);
        av_opt_set(context->priv_data, "crf", rate_factor(settings.quality).c_str(), 0);
        av_opt_set(context->priv_data, "forced-idr", "1", 0);
    } else {
        context->flags |= AV_CODEC_FLAG_QSCALE;
        context->global_quality = quantizer(settings.quality) * FF_QP2LAMBDA;
    }
    if (avcodec_open2(context.get(), &codec, nullptr) < 0)
        return false;
    context_ = std::move(context);
    return true;
}

void VideoEncoder::encode(const cv::Mat& image, std::int64_t time, bool key, const std::function<void(AVPacket&)>& take)
{
    cv::Mat colour = in_colour(image);
    if (colour.size() != cv::Size(frame_->width, frame_->height))
        colour = with_margin(colour);
    scaler_.reset(sws_getCachedContext(scaler_.release(), colour.cols, colour.rows, AV_PIX_FMT_BGR24, frame_->width,
                                       frame_->height, context_->pix_fmt, SWS_BICUBIC, nullptr, nullptr, nullptr));
    if (!scaler_)
        throw std::runtime_error("FFmpeg cannot convert this image");
    checked(av_frame_make_writable(frame_.get()), "no memory for an image");
    const std::uint8_t* const rows[] = {colour.data};
    const int strides[] = {static_cast<int>(colour.step)};
    sws_scale(scaler_.get(), rows, strides, 0, colour.rows, frame_->data, frame_->linesize);
    frame_->pts = time;
    frame_->pict_type = key ? AV_PICTURE_TYPE_I : AV_PICTURE_TYPE_NONE;
    frame_->quality = context_->global_quality;
    checked(avcodec_send_frame(context_.get(), frame_.get()), "an image could not be encoded");
    receive(take);
}

void VideoEncoder::finish(const std::function<void(AVPacket&)>& take)
{
    checked(avcodec_send_frame(context_.get(), nullptr), "the last images could not be encoded");
    receive(take);
}

void VideoEncoder::receive(const std::function<void(AVPacket&)>& take)
{
    for (;;) {
        const int code = avcodec_receive_packet(context_.get(), packet_.get());
        if (code == AVERROR(EAGAIN) || code == AVERROR_EOF)
            return;
        checked(code, "an image could not be encoded");
        take(*packet_);
        av_packet_unref(packet_.get());
    }
}

}  // namespace writing
