// The drones of this machine as background processes, which live on when the one that started them has ended.
#include "engine.hpp"

#include <hive/event/home.hpp>
#include <hive/program.hpp>

#include <algorithm>
#include <deque>
#include <list>
#include <utility>

#include <csignal>
#include <unistd.h>

namespace hive {
namespace {

/// So many at a time that the processors are busy, but the first ones are soon ready.
constexpr std::size_t at_once = 16;
constexpr std::size_t lines_shown = 15;
constexpr std::chrono::seconds grace(3);  ///< as BackgroundProcess::end()

class LocalEngine final : public Engine {
public:
    LocalEngine(std::filesystem::path home, BackgroundProcess::Life life) : home_(std::move(home)), life_(life) {}

    void begin(std::vector<SwarmDrone> drones, Clock::time_point) override
    {
        std::ranges::move(drones, std::back_inserter(waiting_));
    }
    std::vector<Report> poll() override;
    [[nodiscard]] std::vector<int> descriptors() const override;
    void look_again(const std::string& drone, const Error& why) override;
    BackgroundProcess* process(const std::string& drone) override;
    std::vector<SwarmFailure> stop(const std::vector<std::string>& drones, Clock::time_point until) override;

private:
    struct Begun {
        std::string drone;
        BackgroundProcess process;
        bool met = false;  ///< reported
    };

    void start(const SwarmDrone& drone, std::vector<Report>& reports);
    [[nodiscard]] std::optional<Report> look(Begun& begun) const;

    event::Home home_;
    BackgroundProcess::Life life_;
    std::deque<SwarmDrone> waiting_;
    std::list<Begun> begun_;
    std::size_t not_met_ = 0;
};

std::vector<Engine::Report> LocalEngine::poll()
{
    std::vector<Report> reports;
    for (auto& begun : begun_)
        if (!begun.met)
            if (auto report = look(begun)) {
                begun.met = true;
                --not_met_;
                reports.push_back(*std::move(report));
            }
    for (; !waiting_.empty() && not_met_ < at_once; waiting_.pop_front())
        start(waiting_.front(), reports);
    return reports;
}

void LocalEngine::look_again(const std::string& drone, const Error&)
{
    for (auto& begun : begun_)
        if (begun.drone == drone && std::exchange(begun.met, false))
            ++not_met_;
}

BackgroundProcess* LocalEngine::process(const std::string& drone)
{
    const auto found = std::ranges::find(begun_, drone, &Begun::drone);
    return found == begun_.end() ? nullptr : &found->process;
}

std::vector<int> LocalEngine::descriptors() const
{
    std::vector<int> ends;
    for (const auto& begun : begun_)
        if (!begun.met)
            ends.push_back(begun.process.descriptor());
    return ends;
}

void LocalEngine::start(const SwarmDrone& drone, std::vector<Report>& reports)
try {
    auto command = command_of(drone.kind);
    std::ranges::move(arguments_of(drone), std::back_inserter(command.arguments));
    command.environment.push_back("HIVE_HOME=" + home_.directory().string());
    begun_.push_back({drone.name, BackgroundProcess(command.program, command.arguments, command.environment,
                                                    home_.path(drone.name, ".log"), life_)});
    ++not_met_;
} catch (const Error& error) {
    reports.push_back({.drone = drone.name, .error = error});
}

/// A wrapper starts the process that has the name, so that one is in its session.
std::optional<Engine::Report> LocalEngine::look(Begun& begun) const
{
    const auto status = begun.process.ended();
    const bool met = home_.alive(begun.drone);
    if (!status && met && ::getsid(static_cast<pid_t>(home_.holder(begun.drone))) == begun.process.pid())
        return Report{
            .drone = begun.drone,
            .place = {.drone = begun.drone, .host = Place::here, .address = to_text(home_.address(begun.drone))},
            .log = home_.path(begun.drone, ".log").string()};
    if (!status)
        return std::nullopt;
    if (met)
        return Report{.drone = begun.drone,
                      .error =
                          Error(Errc::name_taken, begun.drone + " is running already: another process was faster")};
    return Report{.drone = begun.drone,
                  .error = not_ready(begun.drone, *status, begun.process.last_words(lines_shown))};
}

/// All are asked before one is waited for. Which is 3 s at most, so it is not cut short.
std::vector<SwarmFailure> LocalEngine::stop(const std::vector<std::string>& drones, Clock::time_point)
{
    const auto meant = [&](const std::string& name) { return std::ranges::find(drones, name) != drones.end(); };
    std::erase_if(waiting_, [&](const SwarmDrone& drone) { return meant(drone.name); });
    for (auto& begun : begun_)
        if (meant(begun.drone) && !begun.process.ended())
            ::kill(begun.process.pid(), SIGTERM);
    const auto kill_at = Clock::now() + grace;
    std::erase_if(begun_, [&](Begun& begun) {
        if (!meant(begun.drone))
            return false;
        begun.process.end(kill_at);
        return true;
    });
    return {};
}

}  // namespace

std::unique_ptr<Engine> make_local_engine(const std::filesystem::path& home, BackgroundProcess::Life life)
{
    return std::make_unique<LocalEngine>(home, life);
}

}  // namespace hive
