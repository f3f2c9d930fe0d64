// Sends one event at a time, when it is due and requested.
#include "replay_drone.hpp"

#include <hive/event_text.hpp>
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>

#include <algorithm>
#include <sstream>

namespace replay {
namespace {

using namespace std::chrono_literals;

constexpr auto everything = "events";

/// Are all of these types those of images, which connections may have encoded?
bool are_images(const std::string& types)
{
    std::istringstream list(types);
    bool all = !types.empty();
    for (std::string type; std::getline(list, type, ',');)
        all = all && hive::types_fit(type, hive::vision::image_types);
    return all;
}

hive::Body body_of(const hive::recording::Reader& reader, const hive::recording::Record& record,
                   const hive::Output& output)
{
    if (record.prefix.body_size == 0)
        return {};
    hive::Loan memory = output.loan(record.prefix.body_size);
    reader.body(record, std::as_writable_bytes(std::span(memory.data(), memory.size())));
    return hive::Body(std::move(memory));
}

}  // namespace

ReplayDrone::ReplayDrone(hive::Drone& drone) : drone_(drone)
{
    declare();
    declare_outputs();
    drone_.on_change([this] { apply(); });
    drone_.main([this] { return step(); });
}

void ReplayDrone::declare()
{
    drone_.parameter("file", file_, hive::anything().by_operator(), "path of the recording");
    drone_.parameter("pace", pace_, hive::one_of({"real", "demand"}),
                     "real: recorded timing; demand: the next event when all receivers have asked, none skipped");
    drone_.parameter("speed", speed_, hive::between(0.01, 1000), "with pace=real: how many times as fast as recorded");
    drone_.parameter("loop", loop_, hive::anything(), "repeat at the end");
    drone_.parameter("from", from_, hive::at_least(0).in("s"), "start offset in the recording");
    drone_.parameter("to", to_, hive::at_least(0).in("s"), "end offset in the recording; 0: its end");
}

/// An unreadable file is reported when the drone runs.
void ReplayDrone::declare_outputs()
{
    const auto given = drone_.given("file").value_or("");
    std::vector<hive::recording::Port> ports;
    if (given.is_string() && given != "")
        try {
            ports = hive::recording::ports_of(hive::recording::Reader(given.get<std::string>()).summary().tracks);
        } catch (const std::exception&) {
        }
    for (const auto& port : ports) {
        const auto help = "as it was recorded";
        outputs_.push_back({port, are_images(port.types) ? drone_.output(port.name, hive::vision::image_types, help,
                                                                         hive::vision::encoder())
                                                         : drone_.output(port.name, port.types, help)});
    }
    if (outputs_.empty())
        outputs_.push_back({{everything, "*/*", {}}, drone_.output(everything, "*/*", "all events in recorded order")});
}

Range ReplayDrone::range() const
{
    const auto us = [](double seconds) {
        return static_cast<std::int64_t>(std::min(seconds * 1e6, static_cast<double>(hive::recording::most_time_us)));
    };
    return {us(from_), us(to_)};
}

void ReplayDrone::apply()
{
    if (to_ > 0 && to_ <= from_)
        throw hive::Error(hive::Errc::refused, "to must be after from");
    const Opened wanted{file_, range()};
    if (wanted != opened_ || ended_)
        open(wanted);
    event_.reset();  // prepared again, for the current pace
    timeline_.restart();
    const bool whole = playback_ && opened_.range == Range{};
    drone_.source_events(whole && !loop_ ? playback_->reader().summary().events() : 0);
    if (!playback_)
        drone_.condition("no file: set one, file=PATH");
}

/// If the new one cannot be opened, the old one continues.
void ReplayDrone::open(const Opened& wanted)
{
    std::unique_ptr<Playback> fresh;
    std::vector<std::size_t> output_of;
    if (!wanted.file.empty())
        try {
            fresh = std::make_unique<Playback>(wanted.file, wanted.range);
            output_of = outputs_for(fresh->reader().summary().tracks);
        } catch (const std::exception& error) {
            throw hive::Error(hive::Errc::refused, error.what());
        }
    if (started_)
        rounds_before_ += playback_->rounds() + 1;
    playback_ = std::move(fresh);
    output_of_ = std::move(output_of);
    opened_ = wanted;
    damaged_ = without_body_ = 0;
    if (ended_)
        for (const auto& declared : outputs_)
            declared.output.begin_source();
    started_ = ended_ = asked_before_ = false;
    drone_.condition("waiting for a receiver", hive::Reason::no_receiver);
}

std::vector<std::size_t> ReplayDrone::outputs_for(const std::vector<hive::recording::Track>& tracks) const
{
    std::vector<std::size_t> result(tracks.size(), 0);
    if (outputs_[0].port.name == everything && outputs_[0].port.tracks.empty())
        return result;
    for (const auto& port : hive::recording::ports_of(tracks)) {
        const auto found = std::ranges::find_if(outputs_, [&](const Declared& declared) {
            return declared.port.name == port.name && declared.port.types == port.types;
        });
        if (found == outputs_.end())
            throw std::runtime_error(
                "it has an output " + port.name + " (" + port.types
                + ") that this drone was not started with; start another one: hivectl replay FILE --as NAME");
        for (const auto track : port.tracks)
            result[track] = static_cast<std::size_t>(found - outputs_.begin());
    }
    return result;
}

bool ReplayDrone::has_receivers() const
{
    return std::ranges::any_of(outputs_, [](const Declared& declared) { return declared.output.received(); });
}

/// Receivers of headers request nothing. So if only they are connected, events are sent on demand with recorded timing,
/// unless there were receivers of bodies before, which may reconnect.
ReplayDrone::Step ReplayDrone::next_step()
{
    if (pace_ == "real")
        return Step::when_due;
    const bool asked_now =
        std::ranges::any_of(outputs_, [](const Declared& declared) { return declared.output.wanted(); });
    asked_before_ = asked_before_ || asked_now;
    if (asked_now)
        return Step::when_asked;
    const bool for_watchers = has_receivers() && !asked_before_ && playback_->current()->prefix.body_size == 0;
    return for_watchers ? Step::when_due : Step::none;
}

std::chrono::microseconds ReplayDrone::step()
{
    if (!playback_ || ended_ || (!started_ && !has_receivers()))
        return 1s;
    started_ = true;
    if (!playback_->current())
        return at_end();
    if (!event_ && !prepare())
        return std::chrono::microseconds(loop_ ? 10'000
                                               : 0);  // a loop with nothing but damaged events must not spin the core
    const bool wanted = output().wanted();
    const auto step = next_step();
    const bool waits = step == Step::none;
    drone_.condition(waits ? "waiting for a receiver of bodies" : "",
                     waits ? hive::Reason::watched : hive::Reason::none);
    if (step == Step::none)
        return 1s;
    if (step == Step::when_due) {
        const auto due = timeline_.due(playback_->current()->prefix.time_us, speed_, Timeline::Clock::now());
        if (const auto wait = std::chrono::ceil<std::chrono::microseconds>(due - Timeline::Clock::now()); wait > 0us)
            return wait;
    }
    if (wanted && event_->identity.lossless && (!output().asked() || overtakes()))
        return 1s;
    event_->identity.lossless = event_->identity.lossless && wanted;  // without receivers, nothing is lossless
    send();
    return 0s;
}

/// A receiver of several outputs gets their events in the order of the recording.
bool ReplayDrone::overtakes() const
{
    return std::ranges::any_of(outputs_, [](const Declared& declared) { return declared.output.backlogged(); });
}

/// Reads the header of the current event; false when it is damaged.
bool ReplayDrone::prepare()
try {
    event_ = hive::event_from_text(playback_->reader().text(*playback_->current()));
    auto& identity = event_->identity;
    identity.lossless = identity.lossless || pace_ == "demand";
    identity.shares.clear();  // the recorded shares do not apply to a replay
    // Each round has a new epoch, as if the sources had been restarted, so that stateful drones accept it.
    identity.epoch = std::min(identity.epoch + rounds_before_ + playback_->rounds(), hive::max_json_integer);
    return true;
} catch (const std::exception& error) {
    damaged(error.what());
    return false;
}

void ReplayDrone::take_next()
{
    event_.reset();
    if (const auto pause_us = playback_->advance(loop_); pause_us > 0)
        timeline_.restart(pause_us);
}

/// The body is read only if it has receivers.
void ReplayDrone::send()
{
    const auto record = *playback_->current();
    const auto& to = output();
    hive::Event event = std::move(*event_);
    if (to.wanted() && event.size > 0 && record.prefix.body_size == 0)
        ++without_body_;
    try {
        if (to.wanted())
            event.body = body_of(playback_->reader(), record, to);
    } catch (const std::exception& error) {
        return damaged(error.what());
    }
    take_next();
    to.repeat(std::move(event));
}

void ReplayDrone::damaged(const std::string& what)
{
    ++damaged_;
    drone_.report(hive::Errc::malformed, file_ + ": " + what + "; event skipped");
    take_next();
}

std::chrono::microseconds ReplayDrone::at_end()
{
    ended_ = true;
    const auto& problem = playback_->reader().problem();
    if (!problem.empty())
        drone_.report(hive::Errc::malformed, file_ + ": " + problem);
    std::string text = "end of recording";
    if (damaged_ > 0)
        text += "; damaged events skipped: " + std::to_string(damaged_);
    if (without_body_ > 0)
        text += "; without a body, so for no receiver of bodies: " + std::to_string(without_body_);
    drone_.condition(problem.empty() ? text : text + "; " + problem, hive::Reason::source_ended);
    for (const auto& [port, output] : outputs_)
        output.end(problem);
    return 1s;
}

}  // namespace replay
