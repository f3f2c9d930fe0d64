// Writes one file at a time. When the disk fails the file ends, but never the drone.
#include "write_drone.hpp"

#include "ffmpeg.hpp"

#include <hive/vision/image.hpp>

#include <opencv2/core/utility.hpp>

#include <csignal>

namespace writing {
namespace {

constexpr double usual_fps = 25;  ///< of pictures without a time of their own

std::int64_t number_in(const hive::Json& header, const char* field)
{
    const auto found = header.find(field);
    return found != header.end() && found->is_number_integer() ? found->get<std::int64_t>() : -1;
}

double fps_in(const hive::Json& header)
{
    const auto found = header.find("fps");
    return found != header.end() && found->is_number() ? found->get<double>() : 0;
}

std::string text_in(const hive::Json& header, const char* field)
{
    const auto found = header.find(field);
    return found != header.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string ending_of(const std::string& type) { return type == "image/jpeg" ? ".jpg" : ".png"; }

}  // namespace

WriteDrone::WriteDrone(hive::Drone& drone)
    : drone_(drone), files_(drone.output("files", "application/json", "what has been written, when a file is complete"))
{
    declare();
    drone_.on_start([] {
        cv::setNumThreads(1);            // one drone, one core
        std::signal(SIGXFSZ, SIG_IGN);   // a file over the limit of the process is an error like others
        av_log_set_level(AV_LOG_FATAL);  // what matters is thrown
    });
    drone_.on_change([this] { apply(); });
    drone_.on_event(
        "image", hive::vision::image_types, [this](const hive::Event& event) { take(event); }, "what is written");
    drone_.on_end([this](const std::string& text) { close("end of source", text); });
}

void WriteDrone::declare()
{
    drone_.parameter("file", file_, hive::anything(),
                     "path of the video (.mp4 .mov .mkv .avi), or of a folder of pictures (NAME/); another path ends "
                     "it and begins another; empty: ends it");
    drone_.parameter("overwrite", overwrite_, hive::anything(), "replace what is there already");
    drone_.parameter("quality", quality_, hive::between(1, 100), "of the pictures; more takes more room");
    drone_.parameter(
        "fps", fps_, hive::between(0, 1000).in("fps"),
        "write pictures at this rate; 0: each keeps its time, in the file it comes from or of its capture");
    drone_.parameter("count", count_, hive::at_least(0), "end after this many pictures; 0: no limit");
}

void WriteDrone::run()
{
    drone_.run();
    close("stopped");
}

void WriteDrone::apply()
{
    if (file_ != opened_)
        open();
    say();
}

/// The new file first: if it cannot be, the old one goes on.
void WriteDrone::open()
{
    std::unique_ptr<Sink> fresh;
    if (!file_.empty())
        try {
            fresh = open_sink({file_, overwrite_, quality_});
        } catch (const std::exception& error) {
            throw hive::Error(hive::Errc::refused, error.what());
        }
    close("another file was set");
    opened_ = file_;
    sink_ = std::move(fresh);
    times_ = {};
    written_ = later_ = 0;
    last_ = std::chrono::microseconds(0);
    ended_.clear();
}

void WriteDrone::take(const hive::Event& event)
{
    if (!sink_) {
        later_ += opened_.empty() ? 0 : 1;
        return say();
    }
    write(event);
    if (sink_ && count_ > 0 && written_ >= count_)
        close("count reached");
}

/// A picture that cannot be read is an exception of its own, and the next one is written; but not where the disk fails.
void WriteDrone::write(const hive::Event& event)
{
    Picture picture{.pixels = {}, .sequence = event.identity.sequence, .fps = fps_in(event.header)};
    const auto ending = ending_of(event.type);
    if (event.type != "image/raw" && sink_->takes_encoded(ending)) {
        static_cast<void>(hive::vision::size_of(event.body, event.type));
        picture.encoded = {event.body.data(), event.body.size()};
        picture.ending = ending;
    } else {
        picture.pixels = hive::vision::view(event, {.sixteen_bits = true});
    }
    const auto time = times_.next(moment_of(event));
    try {
        sink_->add(picture, time);
    } catch (const std::exception& error) {
        return fail(error.what());
    }
    ++written_;
    last_ = time;
}

/// What a picture from a file says of its time there; of others, when they were captured. A source on demand captures
/// as fast as the swarm works, which says nothing.
Moment WriteDrone::moment_of(const hive::Event& event) const
{
    const auto& identity = event.identity;
    const auto source = identity.source + "/" + std::to_string(identity.epoch) + "/" + text_in(event.header, "file");
    const auto counted = [&](double fps) {
        return Moment{source, static_cast<std::int64_t>(static_cast<double>(identity.sequence) / fps * 1e6), fps};
    };
    if (fps_ > 0)
        return {"count", static_cast<std::int64_t>(static_cast<double>(written_) / fps_ * 1e6), fps_};
    const double fps = fps_in(event.header);
    if (const auto own = number_in(event.header, "media_time_us"); own >= 0)
        return {source, own, fps};
    if (identity.lossless)
        return counted(fps > 0 ? fps : usual_fps);
    return {source, identity.monotonic_us > 0 ? identity.monotonic_us : identity.captured_us, fps};
}

void WriteDrone::fail(const std::string& problem)
{
    drone_.report(hive::Errc::io, problem + "; the file has ended and holds what came before");
    close("failed", problem);
}

void WriteDrone::close(const std::string& how, const std::string& problem)
{
    const auto sink = std::exchange(sink_, nullptr);
    if (!sink)
        return;
    std::string trouble = problem;
    const auto encoder = sink->encoder();
    try {
        sink->close();
    } catch (const std::exception& error) {
        if (trouble.empty())
            drone_.report(hive::Errc::io, error.what());
        trouble += (trouble.empty() ? "" : "; ") + std::string(error.what());
    }
    ended_ = how;
    drone_.log(opened_ + ": " + std::to_string(written_) + " pictures, ended: " + how);
    if (!drone_.stopping())
        files_.emit({{"file", opened_},
                     {"frames", written_},
                     {"duration_us", last_.count()},
                     {"encoder", encoder},
                     {"ended", how},
                     {"problem", trouble}});
    say();
}

void WriteDrone::say()
{
    if (opened_.empty())
        return drone_.condition("no file: set one, file=PATH");
    if (sink_)
        return drone_.condition("");
    drone_.condition("ended: " + ended_
                     + (later_ > 0 ? "; " + std::to_string(later_) + " pictures came later and are not written" : ""));
}

}  // namespace writing
