// Writes one file at a time. A failure of the disk ends the file, never the drone.
#include "write_drone.hpp"

#include <ffmpeg.hpp>
#include <next_free.hpp>

#include <hive/vision/image.hpp>

#include <opencv2/core/utility.hpp>

#include <csignal>
#include <filesystem>

namespace writing {
namespace {

constexpr double default_fps = 25;  ///< of images without a time of their own

std::int64_t number_in(const hive::Json& header, const char* field)
{
    const auto found = header.find(field);
    return found != header.end() && found->is_number_integer() ? found->get<std::int64_t>() : -1;
}

// No source has a rate beyond these bounds, and times counted by such a rate would overflow.
constexpr double lowest_fps = 0.01, highest_fps = 1000;

double fps_in(const hive::Json& header)
{
    const auto found = header.find("fps");
    const double fps = found != header.end() && found->is_number() ? found->get<double>() : 0;
    return fps >= lowest_fps && fps <= highest_fps ? fps : 0;
}

std::string extension_of(const std::string& type) { return type == "image/jpeg" ? ".jpg" : ".png"; }

}  // namespace

WriteDrone::WriteDrone(hive::Drone& drone)
    : drone_(drone),
      files_(drone.output("files", "application/json", "what has been written, when a file is complete")),
      remembered_(drone.remembered("file"))
{
    declare();
    drone_.on_start([] {
        cv::setNumThreads(1);            // one drone, one core
        std::signal(SIGXFSZ, SIG_IGN);   // exceeding the file size limit is an ordinary error
        av_log_set_level(AV_LOG_FATAL);  // relevant errors are exceptions
    });
    drone_.on_change([this] { apply(); });
    drone_.on_event(
        "image", hive::vision::image_types, [this](const hive::Event& event) { take(event); }, "what is written");
    drone_.on_end([this](const std::string& text) {
        end_former();
        close(present_, "end of source", text);
    });
    drone_.main([this] {
        end_former();
        return std::chrono::hours(1);  // a set calls it at once
    });
}

void WriteDrone::declare()
{
    drone_.parameter(
        "file", file_, hive::anything().by_operator(),
        "video file (.mp4 .mov .mkv .avi) or image folder (NAME/); a new path starts a new file; empty: stop");
    drone_.parameter("overwrite", overwrite_, hive::anything().by_operator(), "replace an existing file or folder");
    drone_.parameter("quality", quality_, hive::between(1, 100),
                     "image quality; higher: larger files; counts from the next file on");
    drone_.parameter(
        "fps", fps_, hive::between(0, highest_fps).in("fps"),
        "write images at this rate, 0.01 or more; 0: keep the time of each, in its source file or of its capture");
    drone_.parameter("count", count_, hive::at_least(0), "stop after this many images; 0: no limit");
}

void WriteDrone::run()
{
    drone_.run();
    end_former();
    close(present_, "stopped");
}

void WriteDrone::apply()
{
    if (fps_ > 0 && fps_ < lowest_fps)
        throw hive::Error(hive::Errc::refused, "fps is 0, or 0.01 or more");
    if (std::exchange(remembered_, false))
        spare_what_was_written();
    if (file_ != present_.path)
        open();
    say();
}

/// The file from before a crash must not be lost: the drone continues in another file, even with `overwrite`.
void WriteDrone::spare_what_was_written()
{
    namespace fs = std::filesystem;
    std::error_code none;
    const bool is_folder = fs::is_directory(file_, none);
    if (!fs::exists(file_, none) || (is_folder && fs::is_empty(file_, none)))
        return;
    const auto before = std::exchange(file_, next_free::after({}, is_folder ? fs::path(file_) / "" : fs::path(file_)));
    drone_.log("kept " + before + ", unfinished when the drone was killed; continuing in " + file_,
               hive::LogLevel::warning);
}

/// Opens the new file first: if that fails, the old one continues. A set that is aborted because another drone refuses
/// it is reverted before the next image: the old file is unchanged, and the new one is still empty.
void WriteDrone::open()
{
    if (former_ && former_->path == file_) {
        present_ = *std::exchange(former_, std::nullopt);
        return;
    }
    std::unique_ptr<Sink> fresh;
    if (!file_.empty())
        try {
            fresh = open_sink({file_, overwrite_, quality_});
        } catch (const std::exception& error) {
            throw hive::Error(hive::Errc::refused, error.what());
        }
    auto before = std::exchange(present_, File{.path = file_, .sink = std::move(fresh)});
    if (!former_)
        former_ = std::move(before);
}

void WriteDrone::end_former()
{
    if (auto former = std::exchange(former_, std::nullopt))
        close(*former, "another file was set");
}

void WriteDrone::take(const hive::Event& event)
{
    end_former();
    if (!present_.sink) {
        static_cast<void>(
            hive::vision::view(event, {.sixteen_bits = true}));  // still throws for anything that is not an image
        present_.later += present_.path.empty() ? 0 : 1;
        return say();
    }
    write(event);
    if (present_.sink && count_ > 0 && present_.written >= count_)
        close(present_, "count reached");
}

/// An unreadable image is an exception, and the next one is written; after a failure of the disk it is not.
void WriteDrone::write(const hive::Event& event)
{
    Image image{.pixels = {}, .sequence = event.identity.sequence, .fps = fps_in(event.header)};
    const auto extension = extension_of(event.type);
    if (event.type != "image/raw" && present_.sink->takes_encoded(extension)) {
        static_cast<void>(hive::vision::size_of(event.body, event.type));
        image.encoded = {event.body.data(), event.body.size()};
        image.extension = extension;
    } else {
        image.pixels = hive::vision::view(event, {.sixteen_bits = true});
    }
    const auto time = present_.times.next(moment_of(event));
    try {
        present_.sink->add(image, time);
    } catch (const std::exception& error) {
        return fail(error.what());
    }
    ++present_.written;
    present_.last = time;
}

/// The time of an image in its file, or of its capture. Capture times of a source on demand depend on the speed of the
/// swarm, so they are not used. The epoch distinguishes files, and rounds of one; the name does not, because in a
/// folder every image has its own.
Moment WriteDrone::moment_of(const hive::Event& event) const
{
    const auto& identity = event.identity;
    const auto source = identity.source + "/" + std::to_string(identity.epoch);
    const auto counted = [&](double fps) {
        return Moment{source, static_cast<std::int64_t>(static_cast<double>(identity.sequence) / fps * 1e6), fps};
    };
    if (fps_ > 0)
        return {"count", static_cast<std::int64_t>(static_cast<double>(present_.written) / fps_ * 1e6), fps_};
    const double fps = fps_in(event.header);
    if (const auto own = number_in(event.header, "media_time_us"); own >= 0)
        return {source, own, fps};
    if (identity.lossless)
        return counted(fps > 0 ? fps : default_fps);
    return {source, identity.monotonic_us > 0 ? identity.monotonic_us : identity.captured_us, fps};
}

void WriteDrone::fail(const std::string& problem)
{
    drone_.report(hive::Errc::io, problem + "; the file was closed with the earlier images");
    close(present_, "failed", problem);
}

void WriteDrone::close(File& file, const std::string& how, const std::string& problem)
{
    const auto sink = std::exchange(file.sink, nullptr);
    if (!sink)
        return;
    std::string last_error = problem;
    const auto encoder = sink->encoder();
    try {
        sink->close();
    } catch (const std::exception& error) {
        if (last_error.empty())
            drone_.report(hive::Errc::io, last_error = error.what());
    }
    if (!last_error.empty())
        if (const auto held = sink->held()) {
            file.written = held->images;
            file.last = held->last;
        }
    file.ended = how;
    drone_.log("closed " + file.path + " images=" + std::to_string(file.written) + " reason=\"" + how + "\"");
    if (!drone_.stopping())
        files_.emit({{"file", file.path},
                     {"frames", file.written},
                     {"duration_us", file.last.count()},
                     {"encoder", encoder},
                     {"ended", how},
                     {"problem", last_error}});
    say();
}

void WriteDrone::say()
{
    if (present_.path.empty())
        return drone_.condition("no file: set one, file=PATH");
    if (present_.sink)
        return drone_.condition("");
    drone_.condition(
        "ended: " + present_.ended
        + (present_.later > 0 ? "; " + std::to_string(present_.later) + " later images were not written" : ""));
}

}  // namespace writing
