// Writes failures with a text that says what happened.
#include "failure_keeper.hpp"

#include <hive/printable.hpp>

#include <algorithm>

namespace hive::service {
namespace {

std::string file_name(const std::string& path) { return path.substr(path.rfind('/') + 1); }

}  // namespace

void FailureKeeper::threw(const Error& error, const std::vector<Event>& inputs)
{
    if (kept_.pass("itself", event::Clock::now()))
        keep({.drone = self_.name,
              .time_us = event::wall_us(),
              .code = std::string(info(error.code()).token),
              .text = shortened(error.what()),
              .inputs = inputs},
             {});
}

event::EncoderThread::Job FailureKeeper::receiver_failed(const event::Outlet::Failing& failing)
{
    constexpr std::size_t max_inputs = 16;
    const auto& [link, receiver, how, events] = failing;
    const auto& peer = link.peer();
    if (receiver.size() <= peer.name.size() + 1 || (link.local() && home_.succession(peer.name)))
        return {};  // a replaced drone has not crashed
    if (!kept_.pass("receivers", event::Clock::now()))
        return {};
    KeptFailure failure{.drone = peer.name,
                        .time_us = event::wall_us(),
                        .run = peer.epoch,
                        .code = how == Fate::passed_on      ? "late"
                                : how == Fate::lost_cut_off ? "silent"
                                                            : "died",
                        .text = how_it_died(link, how),
                        .inputs = {}};
    for (std::size_t i = events.size() - std::min(events.size(), max_inputs); i < events.size(); ++i) {
        Event& input = failure.inputs.emplace_back(events[i]->event());
        input.input = receiver.substr(peer.name.size() + 1);
        input.ticket = {};
    }
    const auto& last = failure.inputs.back();
    const auto edge = last.sender + "." + last.output + "," + last.input;
    return [this, failure = std::move(failure), edge] { keep(failure, edge); };
}

/// A drone on this machine writes its crash record before its connections end.
std::string FailureKeeper::how_it_died(const event::Link& link, Fate how) const
{
    if (how == Fate::passed_on)
        return "worked on it for longer than its lease";
    try {
        const Json crash =
            (link.local() ? home_.read_crash(link.peer().name) : std::nullopt).value_or(Json{{"pid", -1}});
        const Fields fields(crash, "a crash");
        if (fields.integer("pid", -1, max_json_integer) == link.peer().pid) {
            const auto function = fields.text_or("function", ""), source = fields.text_or("source", "");
            return fields.text("signal") + (function.empty() ? "" : " in " + function)
                   + (source.empty() ? "" : " (" + file_name(source) + ")");
        }
    } catch (const Error&) {
        // A truncated file, because of a full disk: the crash is kept without its cause.
    }
    return how == Fate::lost_cut_off ? "was silent and was disconnected"
           : link.local()            ? "its process ended"
                                     : "its connection ended";
}

void FailureKeeper::keep(const KeptFailure& failure, const std::string& edge)
try {
    if (store_.keep(failure, edge) == 0)
        reporter_.log(LogLevel::warning, "an input of " + failure.drone + " is too large to be kept");
} catch (const std::exception& error) {
    reporter_.log(LogLevel::warning, "could not keep what " + failure.drone + " failed at: " + error.what());
}

}  // namespace hive::service
