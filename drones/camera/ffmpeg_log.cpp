// One callback for the process, which finds the watch of its thread.
#include "ffmpeg_log.hpp"

#include <cstdarg>

extern "C" {
#include <libavutil/log.h>
}

namespace camera {
namespace {

thread_local FfmpegLog* watching = nullptr;

/// The format is compared, not the text: the arguments are read only where they are known.
void on_log(void*, int, const char* format_text, std::va_list arguments) noexcept
{
    if (watching == nullptr)
        return;
    const std::string_view format(format_text);
    if (format == "line='%s'\n" || format == "header='%s'\n")
        watching->reply_line(va_arg(arguments, const char*));
    else if (format == "id=%d len=%d\n") {
        (void)va_arg(arguments, int);
        watching->rtp_packet(va_arg(arguments, int));
    } else if (format.starts_with("Picture size %ux%u ")) {
        const std::int64_t width = va_arg(arguments, unsigned), height = va_arg(arguments, unsigned);
        watching->refused_pixels(width, height);
    } else if (format.starts_with("Number of streams exceeds max_streams"))
        watching->refused_streams();
    else if (format.starts_with("Format not on whitelist"))
        watching->refused_format();
}

}  // namespace

FfmpegLogWatch::FfmpegLogWatch(FfmpegLog& log)
{
    watching = &log;
    av_log_set_callback(on_log);
}

FfmpegLogWatch::~FfmpegLogWatch() { watching = nullptr; }

}  // namespace camera
