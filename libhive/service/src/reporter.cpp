// Formats log lines, and emits exception events.
#include "reporter.hpp"

#include "log_line.hpp"

#include <hive/event/emission.hpp>
#include <hive/printable.hpp>

namespace hive::service {

void Reporter::attach(event::Module& module)
{
    module_ = &module;
    exceptions_ = &module.add_outlet({"exceptions", "application/x-hive-exception", "what this drone's code threw"},
                                     protocol::PacketType::exception);
}

void Reporter::log(LogLevel level, const std::string& text) const
{
    if (sink_)
        sink_(level, text);
    else
        write_log_line(level, self_.name, text);
}

void Reporter::report(const Error& error, const Event* cause)
{
    Event event = exception_event(error, cause);
    board_.exception({.code = std::string(info(error.code()).token),
                      .text = event.header.value("text", ""),
                      .policy = event.header.value("policy", ""),
                      .input = event.header.value("input", ""),
                      .time_us = event::wall_us(),
                      .source = event.identity.source,
                      .sequence = event.identity.sequence});
    if (const auto left_out = lines_.pass(cause ? cause->sender : "", event::Clock::now()))
        log(LogLevel::error, std::string("exception: ") + std::string(info(error.code()).token) + ": " + error.what()
                                 + event::left_out_text(*left_out));
    std::optional<Share> own;
    if (event.identity.lossless)
        own = Share{.of = self_.name + ".exceptions", .epoch = self_.epoch, .turn = ++given_};
    if (module_)
        module_->post([this, emission = std::make_shared<const event::Emission>(std::move(event), true, own)] {
            count(emission->event());
            module_->emit(*exceptions_, emission);
        });
}

/// Live events do not count, since their receivers do not get all of them anyway.
void Reporter::count(const Event& exception)
{
    constexpr std::size_t most_sources = 64, most_shown = 160;
    const Identity& of = exception.identity;
    if (!of.lossless || (!failures_.contains(of.source) && failures_.size() == most_sources))
        return;
    Failures& failures = failures_[of.source];
    if (of.epoch > failures.epoch)
        failures = {.epoch = of.epoch};
    ++failures.count;
    last_failure_ = shortened(exception.header.value("text", ""), most_shown);
}

std::string Reporter::failures(const Event* newest) const
{
    std::int64_t count = 0;
    for (const auto& [source, failures] : failures_)
        if (!newest || newest->identity.source != source || newest->identity.epoch <= failures.epoch)
            count += failures.count;
    return count == 0 ? ""
                      : self_.name + " failed at " + std::to_string(count)
                            + (count == 1 ? " event: " : " events, at last: ") + last_failure_;
}

Event Reporter::exception_event(const Error& error, const Event* cause) const
{
    Event event;
    event.identity = cause ? cause->identity
                           : Identity{.source = self_.name,
                                      .epoch = self_.epoch,
                                      .captured_us = event::wall_us(),
                                      .monotonic_us = event::steady_us(),
                                      .hops = {}};
    // One place is kept for the share of the exception itself. The outermost shares say which receivers need it.
    if (auto& shares = event.identity.shares; shares.size() >= event::most_shares)
        shares.resize(event::most_shares - 1);
    if (cause && cause->identity.lossless)
        event.ticket = cause->ticket.of_cause();
    event.sender = self_.name;
    event.kind = self_.kind;
    event.output = "exceptions";
    event.type = "application/x-hive-exception";
    event.header = {{"code", info(error.code()).token},
                    {"text", shortened(error.what())},
                    {"policy", token(board_.policy())},
                    {"input", cause ? cause->input : ""}};
    return event;
}

}  // namespace hive::service
