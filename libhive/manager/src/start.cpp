// One engine and one drone: the loop hears the engine until the drone is placed, then the drone until it is ready.
#include "engines/engine.hpp"
#include "inquiry.hpp"

#include <hive/name.hpp>
#include <hive/program.hpp>
#include <hive/start.hpp>

#include <algorithm>

namespace hive {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Where a drone of this name runs. A place on another machine that does not answer is out of date.
std::optional<Place> running(Application& application, const std::string& name)
{
    if (!std::ranges::binary_search(application.drones(), name))
        return std::nullopt;
    const auto place = application.place(name);
    if (place.host != Place::here && application.status(std::vector{name}).at(0).error)
        return std::nullopt;
    return place;
}

void require_time(const StartOptions& options, Clock::time_point end, const std::string& late)
{
    if (options.cancelled && options.cancelled())
        throw Error(Errc::stopped, "cancelled while " + options.drone.name + " was starting");
    if (Clock::now() >= end)
        throw Error(Errc::timeout, options.drone.name + " was not ready in time" + late, "allow more time");
}

/// Waits until the drone that runs is ready. Is it of the kind? That of a Python file is what the file says.
bool is_meant(Application& application, const StartOptions& options)
{
    Inquiry inquiry(application);
    for (const auto end = Clock::now() + options.limit;; inquiry.wait(std::min(end, Clock::now() + 10ms), {})) {
        const auto answer = application.status(std::vector{options.drone.name}).at(0);
        if (!answer.error && answer.status.state != State::starting)
            return is_python_file(options.drone.kind) || answer.status.kind == options.drone.kind;
        require_time(options, end, "");
    }
}

/// Drops the drone again unless it is ready in the end.
class Start {
public:
    Start(Application& application, const StartOptions& options)
        : application_(application),
          options_(options),
          inquiry_(application),
          engine_(engine_for(application, options)),
          end_(Clock::now() + options.limit)
    {
        engine_->begin({options.drone}, end_);
    }
    ~Start()
    {
        if (!ready_)
            try {
                engine_->stop({options_.drone.name}, std::max(end_, Clock::now()) + 2s);
            } catch (const Error&) {
                // The error that brought us here is thrown.
            }
    }
    Start(const Start&) = delete;
    Start& operator=(const Start&) = delete;

    Place await();

private:
    static std::unique_ptr<Engine> engine_for(Application& application, const StartOptions& options)
    {
        return options.ssh.empty() ? make_local_engine(application.home())
                                   : make_ssh_engine(Json(options.ssh), application.home());
    }
    void poll_engine();
    [[nodiscard]] bool answers();

    Application& application_;
    const StartOptions& options_;
    Inquiry inquiry_;
    std::unique_ptr<Engine> engine_;
    Clock::time_point end_;
    std::optional<Place> place_;
    bool ready_ = false;
};

void Start::poll_engine()
{
    for (auto& report : engine_->poll()) {
        if (report.error)
            throw *report.error;
        if (report.place.host != Place::here)
            application_.replace_places({report.place});
        place_ = report.place;
    }
}

bool Start::answers()
{
    const auto reference = options_.drone.name + "@" + place_->host;
    inquiry_.ask({reference}, 2s);
    for (const auto& answer : inquiry_.take()) {
        if (!answer.error)
            return answer.status.state != State::starting;
        if (answer.error->code() == Errc::not_permitted)
            throw *answer.error;  // another key does not become this one
        engine_->look_again(options_.drone.name, *answer.error);
    }
    return false;
}

Place Start::await()
{
    for (;;) {
        poll_engine();
        ready_ = place_ && answers();
        if (ready_)
            return *place_;
        require_time(options_, end_, " and was stopped");
        inquiry_.wait(std::min(end_, Clock::now() + 10ms), engine_->descriptors());
    }
}

}  // namespace

Place start(Application& application, StartOptions options)
{
    auto& drone = options.drone;
    if (drone.name.empty())
        drone.name = usual_name(drone.kind);
    require_name(drone.name, "drone");
    if (!is_python_file(drone.kind))
        require_name(drone.kind, "kind");
    if (const auto place = running(application, drone.name)) {
        if (options.if_missing && is_meant(application, options))
            return *place;
        throw Error(Errc::name_taken, drone.name + " is running already",
                    "stop it, choose another name (" + drone.name + "-2), or keep it by the option if_missing");
    }
    return Start(application, options).await();
}

}  // namespace hive
