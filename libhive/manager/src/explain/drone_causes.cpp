// Causes from a drone's own status, and from what is known of one that does not answer.
#include "../directory.hpp"
#include "search.hpp"

#include <hive/duration_text.hpp>
#include <hive/name.hpp>
#include <hive/printable.hpp>
#include <hive/program.hpp>
#include <hive/stall.hpp>
#include <hive/transport/address.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace hive::explaining {
namespace {

using What = Cause::What;

constexpr std::int64_t second_us = 1'000'000;
constexpr std::int64_t recent_us = 3 * second_us;

std::int64_t now_us(const Status& status) { return status.epoch + status.uptime_us; }

std::int64_t newest_emission_us(const Status& status)
{
    std::int64_t newest = 0;
    for (const auto& output : status.outputs)
        if (output.name != "exceptions")
            newest = std::max(newest, output.last_emitted_us);
    return newest;
}

std::string ago_text(const Status& status, std::int64_t time_us)
{
    return duration_text(std::max<std::int64_t>(0, now_us(status) - time_us)) + " ago";
}

std::string exception_text(const Status& status)
{
    const auto& exception = *status.last_exception;
    return "exception " + ago_text(status, exception.time_us) + ": " + printable(exception.text);
}

std::string halt_text(const Status& status)
{
    if (!status.halted)
        return "";
    const auto since = ago_text(status, status.halted->time_us);
    if (!status.halted->by.empty())
        return since + ", as " + printable(status.halted->by) + " asked";
    const bool threw = status.last_exception && status.last_exception->policy == "halt";
    return threw ? exception_text(status) : since;
}

std::string crash_text(const CrashedDrone& crash)
{
    return crash.signal + (crash.function.empty() ? "" : " in " + printable(crash.function))
           + (crash.source.empty() ? "" : " at " + printable(crash.source.substr(crash.source.rfind('/') + 1)));
}

std::string abandoned_text(const Status& status)
{
    return std::to_string(processed(status, &InputStatus::abandoned)) + " events abandoned";
}

/// "cam1" and "7700" of "tcp://cam1:7700", which a peer reports; empty: invalid.
std::pair<std::string, std::string> host_and_port(const std::string& text)
try {
    const auto address = transport::parse_address(text);
    return {address.host, std::to_string(address.port)};
} catch (const Error&) {
    return {};
}

/// May it be in a command? A peer reports it: "face", or "/home/me/edges.py".
bool is_plain_kind(const std::string& kind)
{
    return is_name(kind)
           || (is_python_file(kind) && kind.starts_with('/') && is_plain(kind) && kind.find(' ') == std::string::npos);
}

bool is_startable(const std::string& kind)
{
    std::error_code ignored;
    return is_python_file(kind) ? std::filesystem::is_regular_file(kind, ignored) : program_of(kind).has_value();
}

/// A lasting trouble that fails each event, such as a full disk: the condition says how to fix it.
bool throws_its_condition(const Status& status)
{
    return status.last_exception && !status.last_exception->text.empty()
           && status.condition.starts_with(status.last_exception->text);
}

}  // namespace

bool is_plain(const std::string& text)
{
    return std::ranges::all_of(text, [](unsigned char c) {
        return std::isalnum(c) || std::string_view(" _=./:@-").find(static_cast<char>(c)) != std::string_view::npos;
    });
}

std::string command_in(const std::string& advice)
{
    const auto at = advice.find("hivectl ");
    const auto command = at == std::string::npos ? "" : advice.substr(at, advice.find_first_of(",;", at) - at);
    return is_plain(command) ? command : "";
}

std::string p99_text(const Status& status)
{
    const auto longest = std::ranges::max_element(status.inputs, {}, &InputStatus::work_p99_us);
    return longest == status.inputs.end() || longest->work_p99_us == 0
               ? ""
               : ", 99 % within " + duration_text(longest->work_p99_us);
}

std::int64_t work_us(const Status& status)
{
    const auto done = processed(status, &InputStatus::processed) + processed(status, &InputStatus::abandoned);
    return done == 0 ? 0 : (status.busy_us - status.busy_for_us) / done;
}

Cause& Search::add(What what, const std::string& drone, const std::string& text, const std::string& evidence,
                   const std::string& command)
{
    const auto is_same = [&](const Cause& cause) {
        return cause.what == what && cause.drone == drone && cause.text == printable(text);
    };
    if (const auto known = std::ranges::find_if(causes_, is_same); known != causes_.end())
        return *known;
    return causes_.emplace_back(
        Cause{.what = what, .drone = drone, .text = printable(text), .evidence = evidence, .command = command});
}

const Status* Search::before(const StatusAnswer& answer) const
{
    const auto* found = earlier_ ? earlier_->find(answer.drone) : nullptr;
    const auto* earlier = found ? value_of(found->status) : nullptr;
    return earlier && earlier->epoch == std::get<Status>(answer.status).epoch ? earlier : nullptr;
}

bool Search::moves(const StatusAnswer& answer) const
{
    const auto& status = std::get<Status>(answer.status);
    const auto* earlier = before(answer);
    return earlier
           && (emitted(status) > emitted(*earlier)
               || processed(status, &InputStatus::processed) > processed(*earlier, &InputStatus::processed));
}

void Search::silent(const StatusAnswer& answer, const std::string& evidence)
{
    const auto& error = std::get<Error>(answer.status);
    const auto suspended = absent_.suspended.find(answer.drone);
    if (error.code() == Errc::invalid_argument)  // several have this name, and another machine has the right one
        return;
    if (const auto starting = absent_.starting.find(answer.drone); starting != absent_.starting.end())
        add(What::starting, answer.drone, answer.drone + " is starting",
            "process " + std::to_string(starting->second) + " has the name and does not listen yet",
            "hivectl wait " + answer.drone + " --timeout 60");
    else if (error.code() == Errc::not_found)
        not_running(answer.drone, error.what(), evidence);
    else if (suspended != absent_.suspended.end())
        add(What::suspended, answer.drone, "the process of " + answer.drone + " is suspended", evidence,
            "kill -CONT " + std::to_string(suspended->second));
    else if (is_elsewhere(answer.place) && (error.code() == Errc::timeout || error.code() == Errc::unreachable))
        add(What::unreachable, answer.drone,
            answer.drone + " at " + answer.place.host + " does not answer: " + error.what(),
            evidence + (evidence.empty() || lost_text(answer.drone).empty() ? "" : "; ") + lost_text(answer.drone),
            answer.place.ssh.empty() ? "hivectl place list" : "ssh " + answer.place.ssh + " hivectl ps");
    else if (error.code() == Errc::timeout)
        add(What::no_answer, answer.drone, error.what(), evidence,
            restart(answer.drone, "hivectl logs " + answer.drone));
    else if (error.code() == Errc::version_mismatch)  // after an update, its process is that of the old version
        add(What::refused, answer.drone, answer.drone + " is of another version of Hive: " + error.what(), evidence,
            is_elsewhere(answer.place)
                ? (answer.place.ssh.empty() ? "" : "ssh " + answer.place.ssh + " ") + "hivectl --version"
                : restart(answer.drone, "hivectl --version"));
    else
        add(What::refused, answer.drone, error.what() + (error.advice().empty() ? "" : "; " + error.advice()), evidence,
            command_in(error.advice()));
}

Search::Start Search::start_of(const std::string& drone) const
{
    const auto known = absent_.kinds.find(drone);
    if (known != absent_.kinds.end() && absent_.remembered.contains(drone))
        return {.command = start_command(known->second, drone)};
    if (auto elsewhere = start_elsewhere(drone))
        return *std::move(elsewhere);
    if (known != absent_.kinds.end())
        return {.command = start_command(known->second, drone)};
    for (const auto& answer : look_.answers)  // after a stop on purpose, its receivers still know it
        if (const auto* status = value_of(answer.status))
            for (const auto& input : status->inputs)
                if (parse_endpoint(input.from).drone == drone && is_plain_kind(input.kind) && is_startable(input.kind))
                    return {.command = start_command(input.kind, drone)};
    return {};
}

std::optional<Search::Start> Search::start_elsewhere(const std::string& drone) const
{
    for (const auto& answer : look_.answers)
        if (const auto* status = value_of(answer.status))
            for (const auto& input : status->inputs) {
                const bool beside_receiver = input.address.empty();
                if (parse_endpoint(input.from).drone != drone || (beside_receiver && !is_elsewhere(answer.place)))
                    continue;
                Start start{.at = beside_receiver ? answer.place.host : input.address};
                if (!is_plain_kind(input.kind) || !is_name(drone))
                    return start;
                const auto [host, port] = host_and_port(input.address);
                start.there =
                    start_command(input.kind, drone)
                    + (port.empty() ? "" : " --listen tcp://0.0.0.0:" + port);  // where the receivers look for it
                const auto known = absent_.ssh.find(host);
                const auto ssh = beside_receiver ? answer.place.ssh : known != absent_.ssh.end() ? known->second : "";
                if (!ssh.empty())
                    start.command = start.there + " --on " + ssh;
                return start;
            }
    return std::nullopt;
}

std::string Search::restart(const std::string& drone, const std::string& otherwise) const
{
    return absent_.processes.contains(drone) && absent_.kinds.contains(drone) ? "hivectl replace " + drone + " --force"
                                                                              : otherwise;
}

std::string Search::lost_text(const std::string& drone) const
{
    for (const auto& answer : look_.answers)
        if (const auto* status = value_of(answer.status))
            for (const auto& input : status->inputs)
                if (parse_endpoint(input.from).drone == hive::drone_of(drone) && input.disconnected_us > 0)
                    return answer.drone + "." + input.input + " lost it " + ago_text(*status, input.disconnected_us);
    return "";
}

/// "it ran at tcp://cam1:7700; start it there: hivectl start camera"
std::string Search::where_text(const Start& start)
{
    if (start.at.empty())
        return "";
    const bool not_proposed = start.command.empty() && !start.there.empty();
    return "it ran at " + start.at + (not_proposed ? "; start it there: " + start.there : "");
}

/// @param text  empty: "face is not running"
void Search::not_running(const std::string& drone, const std::string& text, const std::string& evidence)
{
    const auto crash = std::ranges::find(absent_.crashed, drone, &CrashedDrone::drone);
    const auto failed = std::ranges::find(absent_.failed, drone, &FailedDrone::drone);
    const auto start = start_of(drone);
    if (failed != absent_.failed.end())
        add(What::failed, drone, drone + " crashes again and again: " + failed->reason, evidence,
            "hivectl logs " + drone);
    else if (crash != absent_.crashed.end())
        add(What::crashed, drone, drone + " has crashed: " + crash_text(*crash), evidence,
            start.command.empty() ? "hivectl logs " + drone : start.command);
    else
        add(What::not_running, drone, text.empty() ? drone + " is not running" : text,
            evidence + (evidence.empty() || start.at.empty() ? "" : "; ") + where_text(start),
            start.command.empty() ? "hivectl ps" : start.command);
}

bool Search::own(const StatusAnswer& answer, bool awaited)
{
    const auto& name = answer.drone;
    const auto& status = std::get<Status>(answer.status);
    if (status.state == State::starting)
        add(What::starting, name, name + " is starting", "for " + duration_text(status.uptime_us),
            "hivectl wait " + name + " --timeout 60");
    else if (status.state == State::halted || status.why == Reason::halted)
        add(What::halted, name, name + " has halted", halt_text(status), "hivectl resume " + name);
    else if (status.why == Reason::set_prepared)
        add(What::set_prepared, name, name + " waits for an application to commit or abort the set that it prepared",
            "", "hivectl replace " + name);
    else if (status.why == Reason::source_ended)
        add(What::source_ended, name, name + " has reached the end of its source",
            std::to_string(emitted(status)) + " events emitted", "hivectl replace " + name);
    else if ((!throws_its_condition(status) && throws(answer)) || stuck(answer))
        return true;
    else if (!status.condition.empty() && status.why != Reason::no_receiver && status.why != Reason::watched)
        add(What::condition, name, name + " reports: " + status.condition,
            throws_its_condition(status) ? abandoned_text(status) : "", "hivectl logs " + name)
            .blocks = !moves(answer);
    else if (status.why == Reason::no_input && !awaited)
        add(What::not_connected, name, "nothing is connected to the inputs of " + name, "", "hivectl describe " + name);
    else
        return false;
    return true;
}

bool Search::throws(const StatusAnswer& answer)
{
    const auto& status = std::get<Status>(answer.status);
    const auto* earlier = before(answer);
    constexpr int events = 3;  // some of which may succeed
    const auto quiet = now_us(status) - newest_emission_us(status);
    if (!earlier || !status.last_exception || now_us(status) - status.last_exception->time_us > recent_us
        || moves(answer) || newest_emission_us(status) > status.last_exception->time_us
        || quiet < events * work_us(status))
        return false;
    const auto failed = processed(status, &InputStatus::abandoned) - processed(*earlier, &InputStatus::abandoned);
    add(What::throws, answer.drone,
        answer.drone + (failed > 0 ? " throws at each event: " : " threw, and has emitted nothing since: ")
            + status.last_exception->text,
        abandoned_text(status) + ", " + std::to_string(processed(status, &InputStatus::processed))
            + " processed; last exception " + ago_text(status, status.last_exception->time_us)
            + ", see hivectl exceptions " + answer.drone,
        "hivectl replace " + answer.drone);
    return true;
}

bool Search::stuck(const StatusAnswer& answer)
{
    const auto& status = std::get<Status>(answer.status);
    constexpr std::int64_t noticeable_us = 5 * second_us;
    constexpr int times = 5;  // the usual time
    const auto usual = work_us(status);
    if (!earlier_ || status.busy_for_us < std::max(noticeable_us, times * usual) || moves(answer)
        || now_us(status) - newest_emission_us(status) < noticeable_us)
        return false;
    const bool is_main = status.callback == "main";
    add(What::stuck, answer.drone,
        answer.drone + " has been " + (is_main ? "in its main function" : "working on one event") + " for "
            + duration_text(status.busy_for_us),
        (is_main ? "" : "input " + printable(status.callback) + ", ")
            + (usual > 0 ? "usually " + duration_text(usual) + " per event" : "nothing processed before"),
        "hivectl replace " + answer.drone);
    return true;
}

Cause& Search::slow(const StatusAnswer& answer, const std::string& evidence)
{
    const auto& status = std::get<Status>(answer.status);
    const auto usual = work_us(status);
    auto& cause = add(What::slow, answer.drone,
                      usual > 0 ? answer.drone + " takes " + duration_text(usual) + " for one event" + p99_text(status)
                                : answer.drone + " works on its first event",
                      evidence + "; busy for " + duration_text(status.busy_for_us), "hivectl top --once");
    cause.blocks = false;
    return cause;
}

/// For a drone that nothing blocks and that reports no cause. The walk may have found its causes before.
void Search::quiet(const StatusAnswer& answer, const std::string& port)
{
    const auto& status = std::get<Status>(answer.status);
    const auto* earlier = before(answer);
    constexpr int periods = 5;
    for (const auto& output : status.outputs) {
        if ((port.empty() ? output.name == "exceptions" : output.name != port) || output.why == Reason::no_receiver)
            continue;
        const auto usual = output.produced > 0 ? (output.last_emitted_us - status.epoch) / output.produced : 0;
        if (quiet_us(status, output) < std::max(recent_us, periods * usual))
            continue;
        if (stalls(status, output) || (status.inputs.empty() && own(answer)))
            continue;  // it reports why
        const auto end = answer.drone + "." + output.name;
        const auto since = "nothing for " + duration_text(quiet_us(status, output)) + ", "
                           + std::to_string(output.produced) + " events before";
        if (output.why == Reason::source_ended && status.why == Reason::source_ended)
            continue;  // the drone itself is the cause
        if (output.why == Reason::source_ended)
            add(What::source_ended, answer.drone, end + " has ended", since, "hivectl replace " + answer.drone);
        else if (status.inputs.empty())
            add(What::silent_source, answer.drone, end + " sends nothing, and the drone does not report why", since,
                "hivectl replace " + answer.drone);
        else if (!earlier_
                 || (earlier
                     && processed(status, &InputStatus::processed) > processed(*earlier, &InputStatus::processed)))
            add(What::emits_nothing, answer.drone,
                answer.drone + " processes events and sends nothing at " + output.name,
                since + ", " + std::to_string(processed(status, &InputStatus::processed)) + " processed",
                "hivectl describe " + answer.drone)
                .blocks = false;
    }
}

void Search::unreceived(const StatusAnswer& answer)
{
    const auto& status = std::get<Status>(answer.status);
    const auto received = [](const OutputStatus& output) {  // now, or earlier by a drone that is gone
        return output.name != "exceptions" && (output.why != Reason::no_receiver || !output.edges.empty());
    };
    if (!status.inputs.empty() || emitted(status) == 0 || std::ranges::any_of(status.outputs, received))
        return;
    add(What::no_receiver, answer.drone, answer.drone + " has no receivers",
        std::to_string(emitted(status)) + " events emitted")
        .blocks = false;
}

}  // namespace hive::explaining
