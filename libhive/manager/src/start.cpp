// Starts one drone with one engine: polls the engine until the drone is placed, then the drone until it is ready.
#include "engines/engine.hpp"
#include "inquiry.hpp"

#include <hive/event/home.hpp>
#include <hive/name.hpp>
#include <hive/program.hpp>
#include <hive/remote.hpp>
#include <hive/start.hpp>

#include <algorithm>

namespace hive {
namespace {

using namespace std::chrono_literals;
using Clock = platform::SteadyClock;
using Life = BackgroundProcess::Life;

constexpr auto time_to_hand_over = 46s;  ///< for the old drone, which may be in a long callback

std::string advice_if_taken(const std::string& name)
{
    return "stop it: hivectl stop " + name + "; or start another under another name, such as " + name + "-2";
}

/// A drone on another machine that does not answer may have been switched off for good.
void require_free(Application& application, const StartOptions& options)
{
    const auto& name = options.drone.name;
    if (!std::ranges::binary_search(application.drones(), name))
        return;
    const auto place = application.place(name);
    const auto where = place.host == Place::here ? "" : ", at " + place.address;
    if (!where.empty() && error_of(application.status(std::vector{name}).at(0).status)) {
        const bool listed = application.forget_place(place);
        if (options.told)
            options.told(name + where + ", does not answer; "
                         + (listed ? "its address was removed" : "it is presumed gone"));
        return;
    }
    throw Error(Errc::name_taken, name + " is running already" + where,
                advice_if_taken(name)
                    + (options.if_missing ? "" : "; or keep it: if_missing (hivectl start --if-missing)"));
}

/// Fills in the defaults.
StartOptions completed(StartOptions options)
{
    auto& drone = options.drone;
    if (drone.name.empty())
        drone.name = usual_name(drone.kind);
    require_name(drone.name, "drone");
    if (!is_python_file(drone.kind) && !takes_over(drone))
        require_name(drone.kind, "kind");
    return options;
}

/// "face@gpu1": the drone of this name on the given machine.
std::string reference_of(const Application& application, const StartOptions& options)
{
    const auto host = options.ssh.empty() ? Place::here : Remote(options.ssh, application.home()).host();
    return options.drone.name + "@" + host;
}

/// Throws Errc::name_taken if a drone of another kind has the name.
void require_kind(const Status& status, const SwarmDrone& wanted)
{
    if (is_of_kind(status, wanted.kind))
        return;
    const auto kind = status.order && !status.order->kind.empty() ? status.order->kind : status.kind;
    throw Error(Errc::name_taken, wanted.name + " is running already; its kind is " + kind + ", not " + wanted.kind,
                advice_if_taken(wanted.name));
}

/// The place of a running drone of this name there, once it is ready. Throws as require_kind().
std::optional<Place> found_ready(Application& application, const StartOptions& options)
{
    Inquiry inquiry(application);
    for (const auto end = Clock::now() + options.limit; Clock::now() < end;
         inquiry.wait(std::min(end, Clock::now() + 10ms), {})) {
        const auto answer = application.status(std::vector{reference_of(application, options)}).at(0);
        if (const auto* error = error_of(answer.status); error && error->code() == Errc::not_found)
            break;
        if (const auto* status = value_of(answer.status); status && status->state != State::starting) {
            require_kind(*status, options.drone);
            return answer.place;
        }
        if (options.cancelled && options.cancelled())
            throw Error(Errc::stopped, "cancelled while " + options.drone.name + " was starting");
    }
    return std::nullopt;
}

}  // namespace

class Start {
public:
    Start(Application& application, StartOptions options, Life life)
        : application_(application),
          options_(std::move(options)),
          inquiry_(application),
          engine_(options_.ssh.empty() ? make_local_engine(application.home(), life)
                                       : make_ssh_engine(Json(options_.ssh), application.home())),
          end_(Clock::now() + options_.limit + (takes_over(options_.drone) ? time_to_hand_over : 0s))
    {
    }

    [[nodiscard]] const std::string& name() const { return options_.drone.name; }
    BackgroundProcess* process() { return engine_->process(name()); }
    /// Returns when the drone is ready. After any error it is stopped.
    Started await();
    /// Processes that could not be stopped.
    std::vector<SwarmFailure> stop();

private:
    Started until_ready();
    void poll_engine();
    [[nodiscard]] std::string subject() const { return subject_of(options_.drone); }
    [[nodiscard]] bool answers();
    void require_time();

    Application& application_;
    StartOptions options_;
    Inquiry inquiry_;
    std::unique_ptr<Engine> engine_;
    Clock::time_point end_;
    std::optional<Started> started_;
};

Started Start::await()
try {
    if (!takes_over(options_.drone))
        require_free(application_, options_);
    engine_->begin({options_.drone}, end_);
    return until_ready();
} catch (const Error& error) {
    std::string text = error.what();
    for (const auto& failure : stop())
        text += "; " + std::string(failure.error.what());
    throw error.reworded(text);
}

Started Start::until_ready()
{
    for (;;) {
        poll_engine();
        if (started_ && answers())
            return *started_;
        require_time();
        inquiry_.wait(std::min(end_, Clock::now() + 10ms), engine_->descriptors());
    }
}

void Start::poll_engine()
{
    for (auto& report : engine_->poll()) {
        if (const auto* error = error_of(report.started))
            throw *error;
        auto& started = std::get<Started>(report.started);
        if (started.found && !options_.if_missing)
            throw Error(Errc::name_taken, name() + " is running already on " + started.place.host,
                        "choose another name, or keep it: if_missing (hivectl start --if-missing)");
        if (started.place.host != Place::here)
            application_.replace_places({started.place});
        started_ = std::move(started);
    }
}

bool Start::answers()
{
    inquiry_.ask({name() + "@" + started_->place.host}, 2s);
    for (const auto& answer : inquiry_.take()) {
        const auto* error = error_of(answer.status);
        if (!error)
            return std::get<Status>(answer.status).state != State::starting;
        if (error->code() == Errc::not_permitted)
            throw engine_->explained(*error);  // a wrong key does not become right by waiting
        engine_->look_again(name(), *error);
    }
    return false;
}

void Start::require_time()
{
    if (options_.cancelled && options_.cancelled())
        throw Error(Errc::stopped, "cancelled while " + subject() + " was starting");
    if (Clock::now() < end_)
        return;
    const auto* const here = process();
    throw Error(Errc::timeout,
                subject() + " was not ready in time and was stopped"
                    + (here ? "; " + log_text(here->last_words()) : ""),
                "allow more time: --timeout SECONDS");
}

std::vector<SwarmFailure> Start::stop()
{
    if (started_ && !started_->found && started_->place.host != Place::here && !takes_over(options_.drone))
        application_.forget_place(started_->place);
    return engine_->stop({name()}, std::max(end_, Clock::now()) + 2s);
}

Started start(Application& application, StartOptions options)
{
    options = completed(std::move(options));
    try {
        return Start(application, options, Life::own).await();
    } catch (const Error& error) {
        if (error.code() != Errc::name_taken || !options.if_missing)
            throw;
        if (const auto place = found_ready(application, options)) {
            const auto log =
                place->host == Place::here ? event::Home(application.home()).path(place->drone, ".log").string() : "";
            return {.place = *place, .log = log, .found = true};
        }
        throw;
    }
}

class TiedDrone::Parts {
public:
    Parts(Application& application, const StartOptions& options)
        : home_(application.home()), start_(application, options, Life::tied)
    {
    }
    ~Parts()
    {
        static_cast<void>(start_.stop());
        std::error_code ignored;
        if (!home_.alive(name()))
            std::filesystem::remove(home_.path(name(), ".log"), ignored);
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;

    void start() { start_.await(); }
    [[nodiscard]] const std::string& name() const { return start_.name(); }
    std::optional<Error> exited()
    {
        const auto status = start_.process()->ended();
        if (!status)
            return std::nullopt;
        return Error(*status == 0 ? Errc::stopped : errc_of_status(*status),
                     name() + " " + how_it_ended(*status) + "; " + log_text(start_.process()->last_words()));
    }

private:
    event::Home home_;
    Start start_;
};

TiedDrone::TiedDrone(Application& application, const StartOptions& options)
{
    auto next = completed(options);
    const auto name = next.drone.name;
    for (int number = 2; !parts_; ++number)
        try {
            auto parts = std::make_unique<Parts>(application, next);
            parts->start();
            parts_ = std::move(parts);
        } catch (const Error& error) {
            if (error.code() != Errc::name_taken)
                throw;
            next.drone.name = name + "-" + std::to_string(number);
        }
}

TiedDrone::~TiedDrone() = default;
const std::string& TiedDrone::name() const { return parts_->name(); }
std::optional<Error> TiedDrone::exited() { return parts_->exited(); }

}  // namespace hive
