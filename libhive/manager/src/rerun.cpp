// Isolates the fresh drone in its own home; an application in that home sends it the inputs.
#include "background_process.hpp"
#include "engines/engine.hpp"
#include "inquiry.hpp"
#include "known_program.hpp"
#include "own_directory.hpp"

#include <hive/event/home.hpp>
#include <hive/program.hpp>
#include <hive/rerun.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>

namespace hive {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::size_t lines_of_log = 15;

/// The options of the drone, from its status or its saved state.
DroneOrder order_of(Application& application, const KeptFailure& failure, const RerunOptions& options)
{
    const auto& drone = failure.drone;
    DroneOrder order{.name = drone, .kind = options.kind};
    if (order.kind.empty())
        order.kind = failure.kind;
    if (failure.version.empty()) {  // kept here: it is not from a file
        auto known = known_program(application, drone);
        const bool same = options.kind.empty() || is_python_file(options.kind) || options.kind == known.kind;
        if (order.kind.empty())
            order.kind = known.kind;
        if (same)
            order.set = std::move(known.parameters);
    }
    if (order.kind.empty())
        order.kind = known_program(application, drone).kind;
    if (order.kind.empty())
        throw Error(Errc::not_found, "nothing is known of the program of " + drone + ", which does not run",
                    "say what it was: --kind KIND");
    for (const auto& [name, value] : options.set.items())
        order.set[name] = value;
    return order;
}

/// Rethrows the error of a drone that has not answered; to be called in a handler.
void require_answered(const Error& error)
{
    constexpr std::array unanswered{Errc::timeout, Errc::connection_lost, Errc::unreachable, Errc::stopped};
    if (std::ranges::find(unanswered, error.code()) != unanswered.end())
        throw;
}

class FreshDrone {
public:
    FreshDrone(Application& application, const KeptFailure& failure, const RerunOptions& options)
        : options_(options),
          failure_(failure),
          order_(order_of(application, failure, options)),
          application_({.name = {},
                        .home = home_.path(),
                        .timeout = 5s,
                        .key = home_.path() / "no-key",
                        .cancelled = options.cancelled}),
          process_(started()),
          end_(Clock::now() + options.limit)
    {
    }
    ~FreshDrone() { process_.end(Clock::now() + (hung_ ? 0s : 3s)); }
    FreshDrone(const FreshDrone&) = delete;
    FreshDrone& operator=(const FreshDrone&) = delete;

    Rerun run();

private:
    Child started() const;
    void until_ready();
    void set_from_file(Rerun& result);
    void set_fitting(const Json& values, Rerun& result);
    std::optional<Status> given();
    std::optional<Status> until_finished();
    [[nodiscard]] std::unique_ptr<Collector> receive();
    [[nodiscard]] bool in_time() const { return !options_.under.empty() || Clock::now() < end_; }
    void pause();
    [[nodiscard]] fs::path log() const { return event::Home(home_.path()).path(order_.name, ".log"); }
    [[nodiscard]] std::string death(int status);
    void leave_debugger(bool finished);

    const RerunOptions& options_;
    const KeptFailure& failure_;
    DroneOrder order_;
    OwnDirectory home_;
    Application application_;
    Child process_;
    Clock::time_point end_;
    bool hung_ = false;
};

Child FreshDrone::started() const
{
    auto command = options_.program.empty()
                       ? command_of(order_.kind)
                       : DroneCommand{.program = options_.program, .arguments = {}, .environment = {}};
    std::vector<std::string> words = options_.under;
    words.push_back(command.program.string());
    std::ranges::move(command.arguments, std::back_inserter(words));
    std::ranges::move(arguments_of(order_), std::back_inserter(words));
    command.environment.push_back("HIVE_HOME=" + home_.path().string());
    const bool attached = !options_.under.empty();
    const transport::Descriptor out(attached ? -1
                                             : ::open(log().c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
    require_done(!attached && !out ? errno : 0, "open the log of the fresh drone");
    return Child({.words = words,
                  .environment = command.environment,
                  .in = attached ? 0 : -1,
                  .out = attached ? 1 : out.get(),
                  .err = attached ? 2 : out.get(),
                  .own_session = !attached,
                  .tied = true});
}

/// Waits until it has exited, or until the next query.
void FreshDrone::pause()
{
    if (options_.cancelled && options_.cancelled())
        throw Error(Errc::stopped, "cancelled");
    Inquiry(application_).wait(Clock::now() + 5ms, {process_.descriptor()});
}

void FreshDrone::until_ready()
{
    const event::Home home(home_.path());
    for (; in_time(); pause()) {
        if (const auto status = process_.ended())
            throw not_ready(order_.name, *status, last_lines(log(), lines_of_log));
        if (!home.alive(order_.name))
            continue;
        const auto answer = application_.status(std::vector{order_.name}).at(0);
        if (const auto* status = value_of(answer.status); status && status->state != State::starting)
            return;
    }
    throw Error(Errc::timeout, "the fresh " + order_.name + " was not ready in time",
                "allow more time: --timeout SECONDS");
}

/// Some drones produce only outputs that have receivers.
std::unique_ptr<Collector> FreshDrone::receive()
{
    std::vector<Endpoint> outputs;
    for (const auto& output : application_.describe(order_.name).outputs)
        if (output.name != "exceptions")
            outputs.push_back({order_.name, output.name});
    return outputs.empty() ? nullptr : application_.collect(outputs);
}

/// Sets what the file says, except what could harm this machine: the file may come from anyone.
void FreshDrone::set_from_file(Rerun& result)
{
    const auto interface = application_.describe(order_.name);
    if (failure_.version != interface.version)
        result.unfit.push_back("the file is of version " + failure_.version + ", and the drone of version "
                               + interface.version);
    Json values = Json::object();
    for (const auto& [name, value] : failure_.parameters.items()) {
        const auto* const parameter = interface.parameter(name);
        if (options_.set.contains(name) || (parameter && value == parameter->default_value))
            continue;
        if (!parameter)
            result.unfit.push_back("this " + interface.kind + " has no parameter " + name);
        else if (parameter->for_operator)
            result.unfit.push_back(name + " affects the machine, so it is not taken from the file; give it: " + name
                                   + "=VALUE");
        else
            values[name] = value;
    }
    if (!values.empty())
        set_fitting(values, result);
}

/// Sets all at once, since some are valid only together; otherwise each that the drone accepts.
void FreshDrone::set_fitting(const Json& values, Rerun& result)
{
    try {
        application_.set(order_.name, values);
        return;
    } catch (const Error& error) {
        require_answered(error);
    }
    for (const auto& [name, value] : values.items())
        try {
            application_.set(order_.name, Json{{name, value}});
        } catch (const Error& error) {
            require_answered(error);
            result.unfit.push_back(error.what());
        }
}

/// Empty: it exited or timed out.
std::optional<Status> FreshDrone::until_finished()
{
    for (; in_time() && !process_.ended(); pause()) {
        const auto answer = application_.status(std::vector{order_.name}).at(0);
        const auto* status = value_of(answer.status);
        if (!status)
            continue;
        std::int64_t finished = 0;
        for (const auto& input : status->left)
            finished += input.processed + input.abandoned + input.duplicates + input.discarded + input.dropped
                        + input.unmatched;
        if (finished >= static_cast<std::int64_t>(failure_.inputs.size()) && status->state != State::busy)
            return *status;
    }
    return std::nullopt;
}

std::string FreshDrone::death(int status)
{
    for (const auto& crash : application_.crashed())
        return crash.signal + (crash.function.empty() ? "" : " in " + crash.function)
               + (crash.source.empty() ? "" : " (" + fs::path(crash.source).filename().string() + ")");
    return (options_.under.empty() ? "" : options_.under.front() + " ") + how_it_ended(status);
}

/// Stops the drone once it has finished; a debugger exits when its user quits.
void FreshDrone::leave_debugger(bool finished)
{
    try {
        if (finished)
            application_.stop(order_.name);
    } catch (const Error&) {
        // It exited by itself.
    }
    while (!process_.ended())
        pause();
}

/// @return  its status once it has finished; empty: it died or hangs
std::optional<Status> FreshDrone::given()
try {
    const auto collector = receive();
    for (const auto& event : failure_.inputs)
        application_.put({order_.name, event.input}, event);
    return until_finished();
} catch (const Error& error) {
    // It may have died before it answered, or be paused in a debugger.
    const auto code = error.code();
    const bool refused = code == Errc::stopped || code == Errc::type_mismatch || code == Errc::not_found;
    if (refused || (options_.under.empty() && !process_.await_end(Clock::now() + 10s)))
        throw;
    return std::nullopt;
}

Rerun FreshDrone::run()
{
    until_ready();
    Rerun result;
    end_ = Clock::now() + options_.limit;
    if (!failure_.version.empty())
        set_from_file(result);
    const auto status = given();
    if (!options_.under.empty())
        leave_debugger(status.has_value());
    if (status) {
        for (const auto& output : status->outputs)
            result.emitted += output.name == "exceptions" ? 0 : output.produced;
        if (const auto& exception = status->last_exception) {
            result.outcome = Rerun::Outcome::threw;
            result.code = exception->code;
            result.text = exception->text;
        }
    } else if (const auto ended = process_.ended()) {
        result.outcome = Rerun::Outcome::died;
        result.text = death(*ended);
    } else {
        result.outcome = Rerun::Outcome::hung;
        hung_ = true;
    }
    result.log = options_.under.empty() ? last_lines(log(), lines_of_log) : "";
    return result;
}

}  // namespace

std::string_view token(Rerun::Outcome outcome)
{
    constexpr std::array<std::string_view, 4> tokens{"passed", "threw", "died", "hung"};
    return tokens[static_cast<std::size_t>(outcome)];
}

Json to_json(const KeptFailure& failure)
{
    Json inputs = Json::array();
    for (const auto& event : failure.inputs)
        inputs.push_back({{"input", event.input},
                          {"sender", event.sender + "." + event.output},
                          {"type", event.type},
                          {"size", event.size},
                          {"source", event.identity.source},
                          {"epoch", event.identity.epoch},
                          {"seq", event.identity.sequence},
                          {"header", event.header}});
    return {{"drone", failure.drone}, {"number", failure.number}, {"time_us", failure.time_us},
            {"code", failure.code},   {"text", failure.text},     {"inputs", std::move(inputs)}};
}

Json to_json(const Rerun& rerun)
{
    return {{"outcome", token(rerun.outcome)}, {"code", rerun.code},   {"text", rerun.text},
            {"emitted", rerun.emitted},        {"unfit", rerun.unfit}, {"log", rerun.log}};
}

Rerun rerun(Application& application, const KeptFailure& failure, const RerunOptions& options)
{
    return FreshDrone(application, failure, options).run();
}

}  // namespace hive
