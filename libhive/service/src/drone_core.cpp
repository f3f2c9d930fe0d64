// Starts, runs and stops a drone.
#include "drone_core.hpp"

#include "failure_keeper.hpp"
#include "requests.hpp"
#include "succession.hpp"
#include "supervised.hpp"

#include <hive/event/ticket.hpp>
#include <hive/platform/process.hpp>

#include <iostream>

namespace hive {

using service::Requests;
using service::Worker;

namespace {

/// More than the ends of a run; a drone that restarts at once is 1 s ahead of its clock.
constexpr std::int64_t most_ends = 1 << 20;

/// Converts values to texts, as on the command line.
std::string in_words(const Json& value) { return value.is_string() ? value.get<std::string>() : to_text(value); }

}  // namespace

/// Each part uses those before it.
struct DroneCore::Running {
    explicit Running(DroneCore& core);
    /// Answers pending requests, ends the network side, and frees the name.
    void end();

    /// Claims the name, unless another drone is to be replaced, then reads the saved state of this name.
    Json first_state(DroneCore& core);

    event::Home home{event::default_home()};
    std::optional<event::NameClaim> succession;
    std::optional<event::NameClaim> claim;  ///< until the end, which this object may outlive
    Json left;                              ///< saved by a drone that crashed, or is to be replaced
    service::ListenWish wish;
    event::Module module;
    service::Supervised supervised;
    service::Listening listening;
    service::FailureKeeper failures;
    Worker worker;
    Requests requests;
};

DroneCore::Running::Running(DroneCore& core)
    : left(first_state(core)),
      wish(service::wished(core.settings_.listen, left)),
      module({.self = core.self_,
              .limits = {},
              .timing = {},
              .keys = service::keys_for(wish),
              .log = [&reporter = core.reporter_](LogLevel level,
                                                  const std::string& text) { reporter.log(level, text); }}),
      supervised(module.context(), core.settings_.ends_process),
      listening(module, home, core.reporter_),
      failures(core.self_, home, core.reporter_),
      worker({.declaration = core.declaration_,
              .board = core.board_,
              .reporter = core.reporter_,
              .emitter = core.emitter_,
              .mailbox = core.mailbox_,
              .module = module,
              .failures = failures}),
      requests({.declaration = core.declaration_,
                .board = core.board_,
                .reporter = core.reporter_,
                .home = home,
                .listening = listening,
                .mailbox = core.mailbox_,
                .module = module,
                .worker = worker,
                .end = [&core] { core.end(); },
                .hand_over = [&core](std::chrono::seconds grace) { return core.hand_over(grace); },
                .order = core.settings_.order})
{
}

/// Peers recognise the next run of a drone by its larger epoch, and the clock may have been set back since the last
/// run. Each end of a source takes an epoch as well, and the state does not say how many.
Json DroneCore::Running::first_state(DroneCore& core)
{
    if (!core.settings_.take_over)
        claim.emplace(home, core.self_.name);
    auto state = core.left_state(home);
    core.self_.epoch = std::max(core.self_.epoch, service::left_epoch(state, core.reporter_) + most_ends);
    return state;
}

void DroneCore::Running::end()
{
    if (module.loop().started())
        module.call([this] {
            requests.end();
            supervised.end();
        });
    module.end();
    listening.end();
    claim.reset();
}

DroneCore::DroneCore(DroneProgram program, DroneSettings settings)
    : settings_(std::move(settings)),
      self_{.name = settings_.name,
            .kind = program.kind,
            .epoch = event::wall_us(),
            .pid = platform::own_pid(),
            .file = settings_.order.kind.starts_with('/') ? settings_.order.kind : ""},
      declaration_(std::move(program)),
      reporter_(self_, board_, settings_.log),
      emitter_(self_, declaration_.interface, mailbox_)
{
}

/// A failed start may have left the network side running: it must end before the parts that it uses.
DroneCore::~DroneCore()
{
    if (running_)
        running_->end();
}

void DroneCore::run()
{
    if (settings_.describe) {
        std::cout << to_json(interface()).dump(2) << std::endl;
        return;
    }
    start();
    running_->worker.run();
    ended();
}

Interface DroneCore::interface() const
{
    Interface interface = declaration_.interface;
    interface.parameters = declaration_.parameters.declared();
    return interface;
}

void DroneCore::start()
{
    if (running_)
        throw Error(Errc::invalid_argument, "a drone runs once");
    declaration_.interface = interface();
    service::settle(settings_.connections, declaration_.interface, self_.name);
    service::settle(settings_.expected, declaration_.interface, self_.name);
    prepare();
}

bool DroneCore::work(std::chrono::milliseconds time)
{
    if (!stopping())
        running_->worker.run(event::Clock::now() + time);
    return !stopping();
}

void DroneCore::finish()
{
    if (!running_ || last_status_)
        return;
    running_->module.call([this] { end(); });
    running_->worker.run();
    ended();
}

/// A handover ends the connections in the turn of the last count, so that every event that arrived is in it.
void DroneCore::ended()
{
    const bool hands_over = board_.handing_over();
    if (hands_over)
        running_->module.settle();
    running_->module.call([&] {
        last_status_ = running_->requests.status();
        if (!hands_over)
            return;
        board_.handed_over();
        running_->module.hand_over();
    });
    if (hands_over)
        reporter_.log(LogLevel::info, "another process continues");
    mailbox_.discard([](const Event&) { return true; });
    running_->end();  // not reset(): the network side may still use it
    reporter_.log(LogLevel::info, "stopped");
}

void DroneCore::prepare()
{
    running_ = std::make_unique<Running>(*this);
    auto& module = running_->module;
    emitter_.attach(module);
    reporter_.attach(module);
    module.on_demand = [this] { mailbox_.nudge(); };
    module.on_failed = [this](const event::EmissionPtr& event) {
        Event cause = event->event();
        if (event->own())
            cause.identity.shares.push_back(*event->own());
        const int attempts = event->own() ? event->own()->attempt : 0;
        reporter_.report(Error(Errc::abandoned, "given up after " + std::to_string(attempts)
                                                    + (attempts == 1 ? " attempt" : " attempts")),
                         &cause);
    };
    module.on_failed_at = [this](const event::Outlet::Failing& failing) {
        if (auto job = running_->failures.receiver_failed(failing))
            running_->module.do_aside(std::move(job));
    };
    module.failures = [this](const Event* newest) { return reporter_.failures(newest); };
    module.on_not_encoded = [this](const event::EmissionPtr& event, const Error& problem) {
        reporter_.report(problem, &event->event());
    };
    begin_work();
}

void DroneCore::begin_work()
{
    const auto values = take_values(running_->left, settings_.take_over.has_value());
    declaration_.on_start();
    declaration_.on_change();
    declaration_.parameters.read_back(values);
    running_->module.start();
    const bool was_halted = settings_.take_over && take_over();
    board_.idle();
    if (settings_.order.halted || was_halted)
        running_->worker.halt();
    reporter_.log(LogLevel::info, "started");
    serve();
}

/// All slow work is done. Also applies the changes that the old drone got meanwhile.
/// @return whether the old drone had halted
bool DroneCore::take_over()
{
    auto& running = *running_;
    const bool halted =
        service::take_over(running.module, running.home, running.claim, running.succession, *settings_.take_over);
    auto left = left_state(running.home);
    if (left == running.left)
        return halted;
    // Values that returned to their default are not in the state any more.
    auto parameters = left.value("parameters", Json::object());
    const auto before = running.left.value("parameters", Json::object());
    for (const auto& parameter : declaration_.parameters.declared())
        if (before.contains(parameter.name) && !parameters.contains(parameter.name))
            parameters[parameter.name] = parameter.default_value;
    left["parameters"] = std::move(parameters);
    running.left = std::move(left);
    running.wish = service::wished(settings_.listen, running.left);
    const auto values = take_values(running.left, false);
    declaration_.on_change();
    declaration_.parameters.read_back(values);
    return halted;
}

/// Restores the values of before a crash, unless the command line sets others.
/// @param all  throw when the drone refuses one of the values, instead of skipping it
/// @return the given parameters
Json DroneCore::take_values(const Json& state, bool all)
{
    auto& parameters = declaration_.parameters;
    const auto& told = settings_.order.on_exception;
    board_.policy(from_token<ExceptionPolicy>(told.empty() ? state.value("policy", "skip") : told, "policy"));
    board_.swarm(settings_.swarm.empty() ? state.value("swarm", "") : settings_.swarm);
    Json saved = state.value("parameters", Json::object());
    for (const auto& [name, value] : settings_.parameters.items())
        saved.erase(name);
    Json values = all ? parameters.checked(saved) : service::still_taken(saved, parameters, reporter_);
    values.update(parameters.checked(settings_.parameters));
    parameters.assign(values);
    return values;
}

void DroneCore::serve()
{
    auto& module = running_->module;
    module.call([&] {
        if (settings_.signals)
            module.on_signal([this](int) { end(); });
        running_->listening.begin(running_->wish, running_->left);
        running_->succession.reset();
        running_->requests.restore(running_->left, settings_.connections, settings_.expected);
        running_->supervised.ready();
    });
}

/// On the network side. If it is handing over, its successor finds no state and ends, too.
void DroneCore::end()
{
    const bool first = board_.stop();
    if (!first && !board_.handing_over())
        return;
    board_.handed_over();
    running_->home.forget_state(self_.name);
    if (!first)
        return;
    mailbox_.nudge();
    running_->supervised.stopping();
    if (settings_.ends_process)
        watchdog_.begin(running_->home.path(self_.name, ".sock"));
}

/// On the network side. As in a halt nothing more is requested, and shared work that was not started is returned.
/// @return  whether it was not ending yet
bool DroneCore::hand_over(std::chrono::seconds grace)
{
    if (!board_.hand_over())
        return false;
    running_->module.halt(true);
    mailbox_.discard(event::came_to_member);
    mailbox_.nudge();
    if (settings_.ends_process)
        watchdog_.begin(running_->home.path(self_.name, ".sock"), grace);
    return true;
}

Json DroneCore::left_state(const event::Home& home) const
{
    return service::left_state(
        home, self_, settings_.take_over ? service::OtherKind::take : service::OtherKind::leave_out, reporter_);
}

std::optional<Json> DroneCore::given(const std::string& parameter) const
{
    if (settings_.parameters.contains(parameter))
        return settings_.parameters[parameter];
    return told_before(parameter);
}

std::optional<Json> DroneCore::told_before(const std::string& parameter) const
{
    if (settings_.describe)
        return std::nullopt;  // without a runtime directory
    const Json told = left_state(event::Home(event::default_home())).value("parameters", Json::object());
    return told.contains(parameter) ? std::optional(told[parameter]) : std::nullopt;
}

/// An engine restarts a crashed drone with the arguments of its first start, which must not override later changes.
bool DroneCore::remembered(const std::string& parameter) const
{
    const auto before = told_before(parameter);
    const auto now = settings_.parameters.find(parameter);
    return before && (now == settings_.parameters.end() || in_words(*now) == in_words(*before));
}

Status DroneCore::status()
{
    if (stopping() && last_status_)
        return *last_status_;
    if (!running_)
        throw Error(Errc::invalid_argument, "status() was called before run()");
    Status now;
    running_->module.call([&] { now = running_->requests.status(); });
    return now;
}

void DroneCore::condition(const std::string& text, Reason why, LogLevel level)
{
    if (!board_.condition(text, why))
        return;
    if (running_)
        running_->supervised.status(text);
    if (!text.empty())
        reporter_.log(level, "condition: " + text);
}

void DroneCore::wake()
{
    mailbox_.nudge();
    if (running_)
        running_->module.loop().interrupt();
}

void DroneCore::stop()
{
    if (!running_)
        throw Error(Errc::invalid_argument, "stop() was called before run()");
    running_->module.post([this] { end(); });
}

}  // namespace hive
