// Runs the drones of this machine as background processes, which outlive the process that started them.
#include "engine.hpp"

#include <hive/event/home.hpp>
#include <hive/program.hpp>

#include <algorithm>
#include <list>
#include <utility>

namespace hive {
namespace {

/// Enough at a time to keep the processors busy, but few enough that the first ones are ready soon.
constexpr std::size_t at_once = 16;
constexpr std::chrono::seconds grace(3);         ///< as BackgroundProcess::end()
constexpr std::chrono::seconds time_to_exit(1);  ///< for a late successor to exit by itself
constexpr int max_attempts = 3;                  ///< to take over

class LocalEngine final : public Engine {
public:
    LocalEngine(std::filesystem::path home, BackgroundProcess::Life life) : home_(std::move(home)), life_(life) {}

    std::vector<Report> poll() override;
    [[nodiscard]] std::vector<int> descriptors() override;
    void look_again(const std::string& drone, const Error& why) override;
    BackgroundProcess* process(const std::string& drone) override;
    std::vector<SwarmFailure> stop(const std::vector<std::string>& drones, Clock::time_point until) override;

private:
    struct Begun {
        SwarmDrone drone;
        BackgroundProcess process;
        std::int64_t predecessor;  ///< 0: none
        Clock::time_point end;     ///< of a successor: to be ready by then
        int attempt = 1;
        bool met = false;  ///< reported
    };

    [[nodiscard]] BackgroundProcess started(const SwarmDrone& drone) const;
    void start(const SwarmDrone& drone, std::vector<Report>& reports);
    [[nodiscard]] std::optional<Report> look(Begun& begun) const;
    [[nodiscard]] std::optional<Report> look_at_successor(Begun& begun) const;
    /// Deadline for the drone to hand over.
    [[nodiscard]] bool has_asked(const Begun& begun) const
    {
        return takes_over(begun.drone) && begun.process.leads(home_.successor(begun.drone.name));
    }
    [[nodiscard]] Report placed(const std::string& drone) const;

    event::Home home_;
    BackgroundProcess::Life life_;
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
                begun.process.let_go();
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
        if (begun.drone.name == drone && std::exchange(begun.met, false))
            ++not_met_;
}

BackgroundProcess* LocalEngine::process(const std::string& drone)
{
    const auto found = std::ranges::find(begun_, drone, [](const Begun& begun) { return begun.drone.name; });
    return found == begun_.end() ? nullptr : &found->process;
}

std::vector<int> LocalEngine::descriptors()
{
    std::vector<int> ends;
    for (auto& begun : begun_)
        if (!begun.met)
            ends.push_back(begun.process.descriptor());
    return ends;
}

BackgroundProcess LocalEngine::started(const SwarmDrone& drone) const
{
    auto command = command_of(drone.kind);
    std::ranges::move(arguments_of(drone), std::back_inserter(command.arguments));
    command.environment.push_back("HIVE_HOME=" + home_.directory().string());
    return {command.program, command.arguments, command.environment, home_.path(drone.name, ".log"), life_};
}

void LocalEngine::start(const SwarmDrone& drone, std::vector<Report>& reports)
try {
    const auto limit = std::chrono::ceil<Clock::duration>(std::chrono::duration<double>(drone.take_over_s));
    begun_.push_back(
        {drone, started(drone), takes_over(drone) ? home_.holder(drone.name) : 0, Clock::now() + limit + time_to_exit});
    ++not_met_;
} catch (const Error& error) {
    reports.push_back({drone.name, error});
}

Engine::Report LocalEngine::placed(const std::string& drone) const
{
    return {drone, Started{.place = {.drone = drone, .host = Place::here, .address = to_text(home_.address(drone))},
                           .log = home_.path(drone, ".log").string()}};
}

std::optional<Engine::Report> LocalEngine::look(Begun& begun) const
{
    const auto& name = begun.drone.name;
    const auto status = begun.process.ended();
    const bool met = home_.alive(name);
    if (!status && met && begun.process.leads(home_.holder(name)))
        return placed(name);
    if (takes_over(begun.drone))
        return look_at_successor(begun);
    if (!status)
        return std::nullopt;
    if (met)
        return Report{name, Error(Errc::name_taken, name + " is running already: another process was faster")};
    return Report{name, not_ready(name, *status, begun.process.last_words())};
}

/// The old drone exits once a successor has asked it to hand over, so another process is started if the successor
/// crashes.
std::optional<Engine::Report> LocalEngine::look_at_successor(Begun& begun) const
{
    const auto& name = begun.drone.name;
    const bool late = Clock::now() >= begun.end && !has_asked(begun);
    if (late)
        begun.process.end();
    const auto status = begun.process.ended();
    if (!status)
        return std::nullopt;
    if (has_asked(begun) && begun.attempt < max_attempts) {
        begun.process = started(begun.drone);
        ++begun.attempt;
        return std::nullopt;
    }
    if (*status == 0 && home_.holder(name) != begun.predecessor && (home_.alive(name) || home_.succession(name)))
        return placed(name);  // it took over, and was replaced itself
    const auto words = begun.process.last_words();
    if (late)
        return Report{name, Error(Errc::timeout, subject_of(begun.drone) + " was not ready in time and was stopped; "
                                                     + log_text(words))};
    return Report{name, not_ready(subject_of(begun.drone), *status, words)};
}

/// Signals all before waiting for one. The wait is at most 3 s, so `until` does not shorten it.
std::vector<SwarmFailure> LocalEngine::stop(const std::vector<std::string>& drones, Clock::time_point)
{
    const auto meant = [&](const std::string& name) { return std::ranges::find(drones, name) != drones.end(); };
    forget_waiting(drones);
    for (auto& begun : begun_)
        if (meant(begun.drone.name) && !has_asked(begun))
            begun.process.terminate();
    const auto kill_at = Clock::now() + grace;
    std::vector<SwarmFailure> remains;
    std::erase_if(begun_, [&](Begun& begun) {
        if (!meant(begun.drone.name))
            return false;
        if (!has_asked(begun))
            begun.process.end(kill_at);
        if (has_asked(begun) && !begun.met && begun.process.ended())
            begun.process = started(begun.drone);  // it asked just before it was stopped
        if (has_asked(begun) && !begun.process.ended())
            remains.push_back({begun.drone.name, Error(Errc::stopped, "it is taking over, and continues by itself")});
        return true;
    });
    return remains;
}

}  // namespace

std::unique_ptr<Engine> make_local_engine(const std::filesystem::path& home, BackgroundProcess::Life life)
{
    return std::make_unique<LocalEngine>(home, life);
}

}  // namespace hive
