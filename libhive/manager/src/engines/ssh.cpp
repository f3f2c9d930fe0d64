// The drones of a machine that ssh reaches: the hivectl there starts and stops them.
#include "engine.hpp"

#include "../last_line.hpp"
#include "../running_command.hpp"

#include <hive/remote.hpp>

#include <algorithm>
#include <atomic>
#include <deque>
#include <list>
#include <set>
#include <sstream>

namespace hive {
namespace {

using namespace std::chrono_literals;

/// What one connection of ssh carries at once: an sshd allows 10 sessions (MaxSessions), and a user may need one.
constexpr std::size_t sessions_at_once = 8;
/// And all engines of this process together, so that descriptors do not run out: each takes three.
constexpr int sessions_everywhere = 64;
constexpr auto patience_there = 60s;  ///< for one drone to be ready
constexpr auto patience_here = patience_there + 15s;
constexpr auto patience_to_stop = 30s;

std::atomic<int> running_everywhere{0};

class SshEngine final : public Engine {
public:
    SshEngine(const std::string& ssh, const std::filesystem::path& home) : ssh_(ssh), remote_(ssh, home) {}

    void begin(std::vector<SwarmDrone> drones) override { std::ranges::move(drones, std::back_inserter(waiting_)); }
    std::vector<Report> poll() override;
    /// The drone was ready when it was reported: the hivectl there waits for that.
    void look_again(const std::string&) override {}
    std::vector<SwarmFailure> stop(const std::vector<std::string>& drones) override;

private:
    /// One `hivectl start` there.
    struct Start {
        Start(std::string name, const std::vector<std::string>& words)
            : drone(std::move(name)), command(words, patience_here)
        {
            ++running_everywhere;
        }
        ~Start() { --running_everywhere; }
        Start(const Start&) = delete;
        Start& operator=(const Start&) = delete;

        std::string drone;
        RunningCommand command;
    };

    [[nodiscard]] bool may_start() const;
    void start_next(std::vector<Report>& reports);
    Report report_of(const std::string& drone, const CommandResult& result);
    Place place_of(const std::string& drone, const Json& started);
    void await_starts(std::chrono::milliseconds patience);
    std::optional<Error> stop_there(const std::vector<std::string>& drones) const;

    std::string ssh_;
    Remote remote_;
    std::string address_;  ///< of the machine; empty: not known yet
    std::deque<SwarmDrone> waiting_;
    std::list<Start> starts_;
    std::set<std::string> begun_;  ///< that may run because of this engine
    bool connected_ = false;       ///< the first session has made the connection that the others share
};

/// A drone that others find: at a port, unless the plan says which.
std::vector<std::string> words_of(SwarmDrone drone)
{
    if (drone.listen.empty())
        drone.listen = "tcp://0.0.0.0";
    std::vector<std::string> words{"start", drone.kind, "--as", drone.name, "--json", "--if-missing", "--timeout"};
    words.push_back(std::to_string(patience_there / 1s));
    const auto program = arguments_of(drone);
    for (std::size_t i = 2; i < program.size(); ++i)  // behind --name NAME
        if (program[i] != "--set")
            words.push_back(program[i]);
    return words;
}

/// What the hivectl there said, without what it puts before it.
std::string complaint_in(const std::string& text)
{
    constexpr std::string_view own = "hivectl start: ";
    std::istringstream lines(text);
    std::string all;
    for (std::string line; std::getline(lines, line);)
        all += (all.empty() ? "" : "\n") + (line.starts_with(own) ? line.substr(own.size()) : line);
    return all;
}

std::vector<std::string> texts_in(const Json& list)
{
    std::vector<std::string> texts;
    for (const auto& item : list)
        if (item.is_string())
            texts.push_back(item.get<std::string>());
    return texts;
}

bool SshEngine::may_start() const
{
    return !waiting_.empty() && starts_.size() < (connected_ ? sessions_at_once : 1)
           && running_everywhere < sessions_everywhere;
}

std::vector<Engine::Report> SshEngine::poll()
{
    std::vector<Report> reports;
    std::erase_if(starts_, [&](Start& start) {
        const auto result = start.command.poll();
        if (result)
            reports.push_back(report_of(start.drone, *result));
        return result.has_value();
    });
    while (may_start())
        start_next(reports);
    return reports;
}

void SshEngine::start_next(std::vector<Report>& reports)
{
    const auto drone = std::move(waiting_.front());
    waiting_.pop_front();
    try {
        starts_.emplace_back(drone.name, remote_.command(words_of(drone)));
        begun_.insert(drone.name);
    } catch (const Error& error) {
        reports.push_back({.drone = drone.name, .error = error});
    }
}

Engine::Report SshEngine::report_of(const std::string& drone, const CommandResult& result)
try {
    if (result.exit_code == 255 || result.exit_code == 127)
        begun_.erase(drone);  // nothing was begun
    remote_.require_there(result);
    connected_ = true;
    if (result.exit_code == 0) {
        const Json started = parse_json(result.out);
        if (Fields(started, "what hivectl start printed").flag_or("found", false))
            begun_.erase(drone);  // somebody else's, or that of a hivectl that was killed: not ours to end
        return {.drone = drone, .place = place_of(drone, started)};
    }
    begun_.erase(drone);  // the hivectl there has ended it
    const auto complaint = complaint_in(result.err);
    const bool key = complaint.find("swarm key") != std::string::npos;
    return {.drone = drone,
            .error = Error(key ? Errc::not_permitted : Errc::failed, remote_.host() + ": " + complaint,
                           key ? "hand the key of this swarm to it: ssh " + ssh_ + " mkdir -p .config/hive && scp "
                                     + "~/.config/hive/swarm.key " + ssh_ + ":.config/hive/"
                               : "")};
} catch (const Error& error) {
    return {.drone = drone, .error = error};
}

Place SshEngine::place_of(const std::string& drone, const Json& started)
{
    if (address_.empty())
        address_ = remote_.address(5s);
    const auto places = texts_in(Fields(started, "what hivectl start printed").array("places"));
    return {.drone = drone, .host = remote_.host(), .address = remote_.met_at(places, address_), .ssh = ssh_};
}

/// A start that is under way there goes on when its ssh is ended here, so it is waited for and then undone.
void SshEngine::await_starts(std::chrono::milliseconds patience)
{
    const auto until = std::chrono::steady_clock::now() + patience;
    for (auto& start : starts_) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
        if (const auto result = start.command.poll(std::max(left, 0ms)))
            static_cast<void>(report_of(start.drone, *result));
    }
    starts_.clear();
}

std::vector<SwarmFailure> SshEngine::stop(const std::vector<std::string>& drones)
{
    std::set<std::string> meant(drones.begin(), drones.end());
    std::erase_if(waiting_, [&](const SwarmDrone& drone) { return meant.contains(drone.name); });
    await_starts(patience_to_stop);
    std::erase_if(meant, [&](const std::string& name) { return !begun_.contains(name); });
    if (meant.empty())
        return {};
    std::vector<SwarmFailure> remains;
    if (stop_there({meant.begin(), meant.end()}))
        for (const auto& name : meant)  // which of them is it?
            if (const auto error = stop_there({name}))
                remains.push_back({name, *error});
    for (const auto& name : meant)
        if (std::ranges::find(remains, name, &SwarmFailure::drone) == remains.end())
            begun_.erase(name);
    return remains;
}

std::optional<Error> SshEngine::stop_there(const std::vector<std::string>& drones) const
try {
    constexpr int not_found = 3;  // of hivectl: it does not run any more
    std::vector<std::string> words{"stop"};
    words.insert(words.end(), drones.begin(), drones.end());
    const auto result = remote_.hivectl(words, patience_to_stop);
    if (result.exit_code == 0 || (drones.size() == 1 && result.exit_code == not_found))
        return std::nullopt;
    return Error(Errc::failed, remote_.host() + ": " + last_line(result.err));
} catch (const Error& error) {
    return error;
}

}  // namespace

std::unique_ptr<Engine> make_ssh_engine(const Json& settings, const std::filesystem::path& home)
{
    if (!settings.is_string())
        throw Error(Errc::invalid_argument, "the engine ssh needs the name of the machine as ssh knows it");
    return std::make_unique<SshEngine>(settings.get<std::string>(), home);
}

}  // namespace hive
