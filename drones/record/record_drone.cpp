// Writes one file at a time. When the disk fails the recording ends, but never the drone.
#include "record_drone.hpp"

#include <next_free.hpp>

#include <hive/recording/event_record.hpp>

#include <algorithm>
#include <csignal>
#include <filesystem>

namespace record {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

constexpr const char* at_end = "end of source";

/// Events that arrived and that the drone's code has not received.
std::int64_t queued(const hive::Status& status)
{
    std::int64_t events = 0;
    for (const auto& input : status.inputs)
        events += input.queued;
    return events;
}

Condition condition_of(const std::string& when)
try {
    return when.empty() ? Condition() : Condition(when);
} catch (const std::invalid_argument& error) {
    throw hive::Error(hive::Errc::refused, error.what());
}

Clock::duration seconds(double count)
{
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(count));
}

}  // namespace

RecordDrone::RecordDrone(hive::Drone& drone) : drone_(drone), remembered_(drone.remembered("file"))
{
    drone_.parameter("file", file_, hive::anything().by_operator(),
                     "recording file; a new path stops this recording and starts another; empty: stop");
    drone_.parameter("overwrite", overwrite_, hive::anything().by_operator(), "replace an existing file");
    drone_.parameter("max_size", max_size_, hive::at_least(0).in("MB"),
                     "stop the recording before the file is larger than this; 0: no limit");
    drone_.parameter("max_duration", max_duration_, hive::at_least(0).in("s"),
                     "stop the recording this long after its first event; 0: no limit");
    drone_.parameter("sync", sync_, hive::between(0, 3600).in("s"),
                     "interval between flushes to disk; 0: left to the system");
    drone_.parameter("when", when_, hive::anything(),
                     "record only around events whose header matches: \"faces>0\"; empty: everything");
    drone_.parameter("before", before_, hive::between(0, 3600).in("s"),
                     "with when: time to record before such an event");
    drone_.parameter("after", after_, hive::between(0, 3600).in("s"),
                     "with when: time from the last such event until the file is closed");
    drone_.on_start(
        [] { std::signal(SIGXFSZ, SIG_IGN); });  // a file over the limit of the process is an error like others
    drone_.on_change([this] { apply(); });
    drone_.on_event(
        "events", "*/*", [this](const hive::Event& event) { take(event); },
        "events to record; connect any number of outputs");
    drone_.on_end([this](const std::string& text) { end(text); });
    drone_.main([this] { return look(); });
}

void RecordDrone::run()
{
    drone_.run();
    part();
    close("stopped");
}

hive::recording::Limits RecordDrone::limits() const
{
    constexpr double max_bytes = 1e18, max_us = 1e15;  // what fits into the numbers
    return {static_cast<std::uint64_t>(std::min(max_size_ * 1e6, max_bytes)),
            std::chrono::microseconds(static_cast<std::int64_t>(std::min(max_duration_ * 1e6, max_us)))};
}

void RecordDrone::apply()
{
    condition_ = condition_of(when_);
    if (folder_.empty())
        choose_folder();
    if (std::exchange(remembered_, false))
        spare_what_was_recorded();
    const Opened wanted{file_, !when_.empty()};
    if (former_ && wanted == former_->opened)
        put_back();
    else if (wanted != opened_)
        open(wanted);
    if (writer_)
        writer_->limits(limits());
    say();
}

/// The start decides where the drone may write: in the folder of its first file, or else in the working directory. A
/// later `set` of a file, perhaps from another machine, cannot reach any other folder.
void RecordDrone::choose_folder()
{
    const fs::path file(file_);
    const bool leads_away = file.is_absolute() || file.lexically_normal().string().starts_with("..");
    folder_ = leads_away ? fs::absolute(file).lexically_normal().parent_path() : fs::current_path();
}

/// The file, seen from the folder.
std::string RecordDrone::below_folder(const std::string& file) const
{
    const auto below = (folder_ / file).lexically_normal().lexically_relative(folder_);
    if (below.empty() || below.string().starts_with(".."))
        throw hive::Error(hive::Errc::refused,
                          file + " does not lie below " + folder_.string() + ", where this recorder may write",
                          "start a recorder there, or with a file there: hivectl start record file=PATH");
    return below.string();
}

/// The file from before a crash must not be lost: the drone continues in another file, even with `overwrite`.
void RecordDrone::spare_what_was_recorded()
{
    if (std::error_code none; !fs::exists(folder_ / file_, none))
        return;
    const auto before = std::exchange(file_, next_free::after(folder_, file_));
    drone_.log("kept " + before + ", unfinished when the drone was killed; continuing in " + file_,
               hive::LogLevel::warning);
}

std::unique_ptr<hive::recording::Writer> RecordDrone::writer_of(const std::string& file) const
{
    const auto below = below_folder(file);
    const std::chrono::milliseconds sync(static_cast<std::int64_t>(sync_ * 1000));
    try {
        return std::make_unique<hive::recording::Writer>(
            hive::recording::WriterSettings{below, folder_, overwrite_, limits(), sync});
    } catch (const hive::Error&) {
        throw;
    } catch (const std::exception& error) {
        throw hive::Error(hive::Errc::refused, error.what());
    }
}

/// Opens the new file first: if that fails, the old one continues. The old one is not ended yet, because the set may
/// still be aborted.
void RecordDrone::open(const Opened& wanted)
{
    part();
    auto fresh = file_.empty() || wanted.around ? nullptr : writer_of(file_);
    if (wanted.around && !fs::is_directory(folder_ / fs::path(below_folder(file_)).parent_path()))
        throw hive::Error(hive::Errc::refused, "the folder of " + file_ + " is missing");
    count_dropped();
    former_ = Former{opened_, writes_, ended_, std::move(writer_), dropped_};
    opened_ = wanted;
    begin(wanted.around ? "" : file_, std::move(fresh));
}

/// A set of another file was aborted: continues the former recording, and removes the new one, which has no event yet.
void RecordDrone::put_back()
{
    if (std::error_code ignored; writer_)
        fs::remove(folder_ / writes_, ignored);
    opened_ = former_->opened;
    writes_ = former_->writes;
    ended_ = former_->ended;
    writer_ = std::move(former_->writer);
    dropped_ = std::move(former_->dropped);
    former_.reset();
}

/// The set of another file is committed, because the drone runs no other code before the decision.
void RecordDrone::part()
{
    const auto former = std::exchange(former_, std::nullopt);
    if (former && !opened_.around)
        static_cast<void>(last_.take());  // they belong to no file
    if (former && former->writer)
        finish(*former->writer, former->writes, "another file was set");
}

void RecordDrone::begin(const std::string& file, std::unique_ptr<hive::recording::Writer> writer)
{
    writes_ = file;
    ended_.clear();
    count_dropped();
    for (auto& [from, dropped] : dropped_)
        dropped.total = 0;
    writer_ = std::move(writer);
}

/// A file that has everything of its sources is complete: it gets its index and its end.
void RecordDrone::end(const std::string& text)
{
    part();
    if (!writer_ || !writer_->ended().empty() || writer_->summary().events() == 0)
        return;
    const auto how = text.empty() ? at_end : std::string(at_end) + ": " + text;
    close(how);
    if (!opened_.around)
        ended_ = how;
    say();
}

/// A restarted or another source is recorded into a new file, so that a complete one stays unchanged.
void RecordDrone::go_on()
{
    const auto next = next_free::after(folder_, writes_);
    begin(next, writer_of(next));
    drone_.log("continuing in " + next + ", since events arrived after the end");
}

void RecordDrone::close(const std::string& how)
{
    if (!writer_)
        return;
    count_dropped();
    const bool was_to_record = writer_->ended().empty() || !writer_->failure().empty();  // no limit was reached
    if (how == "stopped" && was_to_record)
        if (const auto waiting = queued(drone_.status()); waiting > 0)
            writer_->lost("*", "still waiting when the drone was stopped", waiting);
    finish(*writer_, writes_, how);
    writer_.reset();
}

void RecordDrone::finish(hive::recording::Writer& writer, const std::string& file, const std::string& how)
{
    writer.finish(how);
    drone_.log("closed " + file + " events=" + std::to_string(writer.summary().events()) + " reason=\"" + writer.ended()
               + "\"");
}

void RecordDrone::take(const hive::Event& event)
{
    part();
    if (opened_.around)
        return take_around(event);
    if (!writer_ && !ended_.empty())
        go_on();
    if (!writer_)
        return;
    append(event);
    if (!writer_->ended().empty())
        say();
}

/// A failed disk makes each further event an exception, so that it counts as abandoned and not as processed.
void RecordDrone::append(const hive::Event& event)
{
    const bool had_failed = !writer_->failure().empty();
    hive::recording::append(*writer_, event);
    if (writer_->failure().empty())
        return;
    if (!had_failed)
        say();
    throw hive::Error(hive::Errc::io, failure_text());
}

std::string RecordDrone::failure_text() const
{
    return writer_->failure() + ": " + (folder_ / writes_).lexically_normal().string();
}

void RecordDrone::take_around(const hive::Event& event)
{
    last_.forget_before(event.received - seconds(before_));
    const bool fits = condition_.holds(event.header);
    if (fits)
        clip_ends_ = Clock::now() + seconds(after_);
    if (clip_is_over())
        close("the event is over");
    if (fits && !writer_)
        begin_clip();
    if (writer_)
        append(event);
    else
        last_.keep(event);
}

bool RecordDrone::clip_is_over() const { return opened_.around && writer_ && Clock::now() >= clip_ends_; }

/// Each clip is a file: the first is that of the parameter, unless it exists.
void RecordDrone::begin_clip()
{
    std::error_code none;
    const bool is_first = writes_.empty() && (overwrite_ || !fs::exists(folder_ / file_, none));
    const auto next = is_first ? file_ : next_free::after(folder_, writes_.empty() ? file_ : writes_);
    begin(next, writer_of(next));
    for (const auto& event : last_.take())
        hive::recording::append(*writer_, event);
    drone_.log("recording " + next + ", since " + when_);
    say();
}

/// Checks a few times per second, so that a limit or a failed disk is detected without an event.
std::chrono::microseconds RecordDrone::look()
{
    part();
    if (clip_is_over())
        close("the event is over");
    if (!writer_) {
        last_.forget_before(Clock::now() - seconds(before_));
        say();
        return 1s;
    }
    const bool had_failed = !writer_->failure().empty();
    writer_->look(Clock::now());
    if (!had_failed && !writer_->failure().empty())  // without an event, at which it would be reported
        drone_.report(hive::Errc::io, failure_text());
    if (Clock::now() >= next_count_) {
        count_dropped();
        next_count_ = Clock::now() + 1s;
    }
    say();
    return 200ms;
}

/// Adds the losses of each connection at this end since the last check.
void RecordDrone::count_dropped()
{
    for (const auto& input : drone_.status().inputs) {
        Dropped& dropped = dropped_[input.from];
        dropped.total += input.dropped >= dropped.seen ? input.dropped - dropped.seen : input.dropped;
        dropped.seen = input.dropped;
        if (writer_ && dropped.total > 0)
            writer_->lost(input.from, "dropped by the recorder: it could not keep up", dropped.total);
    }
}

void RecordDrone::say()
{
    if (!ended_.empty())
        return drone_.condition("ended: " + ended_ + "; " + writes_
                                + (ended_ == at_end ? " is complete" : " has everything else"));
    if (!writer_ && (file_.empty() || !opened_.around))
        return drone_.condition("no file: set one, file=PATH");
    if (!writer_)
        return drone_.condition("waiting for " + when_
                                + (last_.full() ? "; keeps less than before=SECONDS, 256 MB" : ""));
    if (!writer_->failure().empty())
        return drone_.condition(failure_text() + "; set file=" + next_free::after(folder_, writes_));
    const std::string continues = opened_.around            ? "recording " + writes_
                                  : writes_ == opened_.file ? ""
                                                            : "continuing in " + writes_;
    drone_.condition(writer_->ended().empty() ? continues : "ended: " + writer_->ended());
}

}  // namespace record
