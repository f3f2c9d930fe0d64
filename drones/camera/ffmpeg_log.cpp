// One callback for the process, which finds the watch of its thread.
#include "ffmpeg_log.hpp"

#include <array>
#include <cstdarg>
#include <cstdio>

extern "C" {
#include <libavutil/log.h>
}

namespace camera {
namespace {

thread_local FfmpegLog* watching = nullptr;

bool is_demuxer(void* object)
{
    const auto* kind = object ? *static_cast<const AVClass* const*>(object) : nullptr;
    return kind && (kind->get_category ? kind->get_category(object) : kind->category) == AV_CLASS_CATEGORY_DEMUXER;
}

std::string text_of(const char* format, std::va_list arguments)
{
    std::array<char, 200> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    return std::string(text.data()).substr(0, std::string_view(text.data()).find('\n'));
}

/// The format is compared, not the text: the arguments are read only where they are known.
void on_log(void* object, int level, const char* format_text, std::va_list arguments) noexcept
{
    if (watching == nullptr)
        return;
    const std::string_view format(format_text);
    if (format == "line='%s'\n" || format == "header='%s'\n")
        watching->reply_line(va_arg(arguments, const char*));
    else if (format == "id=%d len=%d\n") {
        (void)va_arg(arguments, int);
        watching->rtp_packet(va_arg(arguments, int));
    } else if (format == "SDP:\n%s\n") {
        watching->description(va_arg(arguments, const char*));
    } else if (format.starts_with("Picture size %ux%u ")) {
        const std::int64_t width = va_arg(arguments, unsigned), height = va_arg(arguments, unsigned);
        watching->refused_pixels(width, height);
    } else if (format.starts_with("Number of streams exceeds max_streams"))
        watching->refused_streams();
    else if (format.starts_with("Format not on whitelist"))
        watching->refused_format();
    else if (format == "error y=%d x=%d\n" || format == "overread %d\n")
        watching->damaged_scan();
    else if (level <= AV_LOG_ERROR && is_demuxer(object))
        watching->demuxer_error(text_of(format_text, arguments));
}

}  // namespace

FfmpegLogWatch::FfmpegLogWatch(FfmpegLog& log)
{
    watching = &log;
    av_log_set_callback(on_log);
}

FfmpegLogWatch::~FfmpegLogWatch() { watching = nullptr; }

}  // namespace camera
