// Runs drones on another machine over ssh: the hivectl there starts and stops them.
#include "engine.hpp"

#include "../last_line.hpp"
#include "../running_command.hpp"

#include <hive/failure.hpp>
#include <hive/transport/key.hpp>
#include <hive/remote.hpp>

#include <algorithm>
#include <atomic>
#include <deque>
#include <list>
#include <map>
#include <set>
#include <sstream>

namespace hive {
namespace {

using namespace std::chrono_literals;

/// Sessions of one ssh connection: an sshd allows 10 (MaxSessions), and the user may need one.
constexpr std::size_t sessions_at_once = 8;
/// Sessions of all engines of this process, so that descriptors do not run out: each takes three.
constexpr int sessions_everywhere = 64;
constexpr auto a_moment_more = 2s;  ///< more than a start there may take, so that its outcome arrives here
constexpr auto patience_to_stop = 30s;
constexpr auto patience_to_look = 10s;
constexpr auto patience_for_keys = 5s;
constexpr auto look_every = 1s;  ///< interval of checking a drone that was ready there and does not answer here
constexpr const char* lines_of_log = "15";
constexpr int not_found = 3;  ///< the exit code of hivectl if a drone is not running

std::atomic<int> running_everywhere{0};

class SshEngine final : public Engine {
public:
    SshEngine(const std::string& ssh, const std::filesystem::path& home) : ssh_(ssh), remote_(ssh, home) {}

    void begin(std::vector<SwarmDrone> drones, Clock::time_point until) override
    {
        std::ranges::move(drones, std::back_inserter(waiting_));
        until_ = until;
    }
    std::vector<Report> poll() override;
    [[nodiscard]] std::vector<int> descriptors() override;
    void adopt(const std::vector<std::string>& drones) override { begun_.insert(drones.begin(), drones.end()); }
    void look_again(const std::string& drone, const Error& why) override;
    [[nodiscard]] Error explained(const Error& error) const override;
    std::vector<SwarmFailure> stop(const std::vector<std::string>& drones, Clock::time_point until) override;

private:
    /// A drone that was ready there and does not answer here.
    struct Silent {
        Error why;
        int found_running = 0;  ///< number of checks
        Clock::time_point next_look{};
    };
    /// One running hivectl there.
    struct Session {
        Session(std::string name, const std::vector<std::string>& words, std::chrono::milliseconds limit)
            : drone(std::move(name)), command(words, limit)
        {
            ++running_everywhere;
        }
        ~Session() { --running_everywhere; }
        Session(const Session&) = delete;
        Session& operator=(const Session&) = delete;

        std::string drone;
        RunningCommand command;
    };

    [[nodiscard]] bool may_start() const;
    void start_next(std::vector<Report>& reports);
    Report report_of(const std::string& drone, const CommandResult& result);
    [[nodiscard]] Error error_of(const CommandResult& result) const;
    [[nodiscard]] std::optional<std::set<std::string>> keys_there() const;
    void look_at_the_silent(std::vector<Report>& reports);
    void hear_running(const std::string& drone, std::vector<Report>& reports);
    void read_log(const std::string& drone, std::vector<Report>& reports);
    Place place_of(const std::string& drone, const Json& places);
    void await_starts(Clock::time_point until);
    [[nodiscard]] std::optional<Error> stop_there(const std::vector<std::string>& drones,
                                                  Clock::time_point until) const;

    std::string ssh_;
    Remote remote_;
    std::string address_;  ///< of the machine; empty: not known yet
    std::deque<SwarmDrone> waiting_;
    std::list<Session> starts_;
    std::list<Session> looks_, logs_;  ///< checks of drones that were ready there and do not answer here
    std::map<std::string, Silent> silent_;
    Clock::time_point until_{};    ///< deadline for all to be ready
    std::set<std::string> begun_;  ///< that this engine may have started
    bool connected_ = false;       ///< the first session has opened the connection that the others share
};

/// For hivectl: whole seconds, at least 1.
std::int64_t seconds_until(Engine::Clock::time_point until)
{
    return std::max<std::int64_t>(1, std::chrono::ceil<std::chrono::seconds>(until - Engine::Clock::now()).count());
}

std::chrono::milliseconds time_until(Engine::Clock::time_point until)
{
    return std::chrono::ceil<std::chrono::milliseconds>(
        std::max(until - Engine::Clock::now(), Engine::Clock::duration(0)));
}

/// The hivectl command, with those options of a drone's program that hivectl has too.
std::vector<std::string> words_of(std::vector<std::string> words, const SwarmDrone& drone)
{
    const auto program = arguments_of(drone);
    for (std::size_t i = 2; i < program.size(); ++i)  // after --name NAME
        if (program[i] != "--set")
            words.push_back(program[i]);
    return words;
}

/// Adds a listening address, unless the plan has one.
std::vector<std::string> words_to_start(SwarmDrone drone, Engine::Clock::time_point until)
{
    if (drone.listen.empty())
        drone.listen = "tcp://0.0.0.0";
    return words_of({"start", drone.kind, "--as", drone.name, "--json", "--if-missing", "--timeout",
                     std::to_string(seconds_until(until))},
                    drone);
}

std::vector<std::string> words_to_replace(SwarmDrone drone)
{
    std::vector<std::string> words{"replace", drone.name, "--json", "--timeout", std::to_string(drone.take_over_s)};
    if (!drone.kind.empty())
        words.insert(words.end(), {"--kind", drone.kind});
    if (drone.lose_state)
        words.emplace_back("--lose-state");
    drone.take_over_s = 0;
    return words_of(std::move(words), drone);
}

bool SshEngine::may_start() const
{
    return !waiting_.empty() && starts_.size() < (connected_ ? sessions_at_once : 1)
           && running_everywhere < sessions_everywhere;
}

std::vector<Engine::Report> SshEngine::poll()
{
    std::vector<Report> reports;
    std::erase_if(starts_, [&](Session& start) {
        const auto result = start.command.poll();
        if (result)
            reports.push_back(report_of(start.drone, *result));
        return result.has_value();
    });
    while (may_start())
        start_next(reports);
    look_at_the_silent(reports);
    return reports;
}

std::vector<int> SshEngine::descriptors()
{
    std::vector<int> all;
    for (const auto* sessions : {&starts_, &looks_, &logs_})
        for (const auto& session : *sessions)
            std::ranges::copy(session.command.descriptors(), std::back_inserter(all));
    return all;
}

/// The drone was ready when it was reported, since the hivectl there waits for that, but may have exited since.
void SshEngine::look_again(const std::string& drone, const Error& why)
{
    const auto now = Clock::now();
    auto& silent = silent_.try_emplace(drone, Silent{.why = why}).first->second;
    silent.why = why;
    if (now < silent.next_look || looks_.size() + logs_.size() >= sessions_at_once
        || running_everywhere >= sessions_everywhere)
        return;
    silent.next_look = now + patience_to_look + look_every;
    looks_.emplace_back(drone, remote_.command({"ps", drone}), patience_to_look);
}

void SshEngine::look_at_the_silent(std::vector<Report>& reports)
{
    std::erase_if(looks_, [&](Session& look) {
        const auto result = look.command.poll();
        if (result && !result->late && result->exit_code == not_found)
            read_log(look.drone, reports);
        else if (result && !result->late && result->exit_code == 0)
            hear_running(look.drone, reports);
        return result.has_value();
    });
    std::erase_if(logs_, [&](Session& log) {
        const auto result = log.command.poll();
        if (result)
            reports.push_back({.drone = log.drone,
                               .error = Error(Errc::failed, remote_.host() + ": " + log.drone
                                                                + " was ready and has ended since; its log says:\n"
                                                                + (result->out.empty() ? "(nothing)" : result->out))});
        return result.has_value();
    });
}

/// It may just be exiting there, or one answer may have been late, so it is checked twice.
void SshEngine::hear_running(const std::string& drone, std::vector<Report>& reports)
{
    auto& [why, found_running, next_look] = silent_.at(drone);
    next_look = Clock::now() + look_every;
    if (++found_running < 2)
        return;
    reports.push_back(
        {.drone = drone,
         .error =
             Error(why.code(), drone + " runs on " + remote_.host() + " and is not reached from here: " + why.what(),
                   why.advice().empty() ? "open its port to this machine, or choose one that is open: \"listen\""
                                        : why.advice())});
}

void SshEngine::read_log(const std::string& drone, std::vector<Report>& reports)
try {
    logs_.emplace_back(drone, remote_.command({"logs", drone, "-n", lines_of_log}), patience_to_look);
} catch (const Error& error) {
    reports.push_back({.drone = drone, .error = error});
}

void SshEngine::start_next(std::vector<Report>& reports)
{
    const auto drone = std::move(waiting_.front());
    waiting_.pop_front();
    try {
        starts_.emplace_back(
            drone.name, remote_.command(takes_over(drone) ? words_to_replace(drone) : words_to_start(drone, until_)),
            time_until(until_ + a_moment_more));
        if (!takes_over(drone))
            begun_.insert(drone.name);
    } catch (const Error& error) {
        reports.push_back({.drone = drone.name, .error = error});
    }
}

Engine::Report SshEngine::report_of(const std::string& drone, const CommandResult& result)
try {
    if ((result.exit_code == 255 && !connected_) || result.exit_code == 127)
        begun_.erase(drone);  // nothing was started; but an established connection may have ended after a start
    remote_.require_there(result);
    connected_ = true;
    if (result.exit_code == 0) {
        const Json started = parse_json(result.out);
        const Fields fields(started, "what hivectl start printed");
        const bool found = fields.flag_or("found", false);
        if (found)
            begun_.erase(drone);  // another user's, or of a killed hivectl: not ours to stop
        return {.drone = drone,
                .place = place_of(drone, fields.array("places")),
                .found = found,
                .log = fields.text_or("log", "")};
    }
    if (result.exit_code < 128)  // else a signal ended ssh
        begun_.erase(drone);     // the hivectl there has stopped it
    return {.drone = drone, .error = explained(error_of(result))};
} catch (const Error& error) {
    return {.drone = drone, .error = error};
}

/// The error of the hivectl there, or its last line.
Error SshEngine::error_of(const CommandResult& result) const
{
    const auto error = failure_in(result.err).value_or(Error(errc_of_exit(result.exit_code), last_line(result.err)));
    return error.reworded(remote_.host() + ": " + error.what());
}

/// The user's keys there, by id; nothing: unknown.
std::optional<std::set<std::string>> SshEngine::keys_there() const
try {
    const auto listed = remote_.hivectl({"key", "show", "--json"}, patience_for_keys);
    std::set<std::string> ids;
    if (listed.exit_code == 0)
        for (const auto& key : parse_json(listed.out))
            ids.insert(Fields(key, "what hivectl key show printed").text("id"));
    return listed.exit_code == 0 || listed.exit_code == not_found ? std::optional(ids) : std::nullopt;
} catch (const Error&) {
    return std::nullopt;
}

/// A refusal may be due to a missing or different key there.
Error SshEngine::explained(const Error& error) const
try {
    if ((error.code() != Errc::refused && error.code() != Errc::not_permitted) || default_key_file().empty())
        return error;
    const auto file = default_key_file();
    const auto here = read_key_file(file);
    const auto there = keys_there();
    if (!there || std::ranges::any_of(here, [&](const SwarmKey& key) { return there->contains(key.id); }))
        return error;
    return {error.code(), error.what(),
            remote_.host() + (there->empty() ? " has no swarm key" : " has another swarm key") + "; copy the one of "
                + "this machine: " + copy_of_key(file, ssh_)};
} catch (const Error&) {
    return error;  // no key here
}

Place SshEngine::place_of(const std::string& drone, const Json& places)
{
    if (address_.empty())
        address_ = remote_.address(5s);
    std::vector<std::string> texts;
    for (const auto& place : places)
        texts.push_back(place.is_string() ? place.get<std::string>() : "");
    return {.drone = drone, .host = remote_.host(), .address = remote_.met_at(texts, address_), .ssh = ssh_};
}

/// A start continues there if its ssh is stopped here, so this waits for it, as long as the hivectl there may take, and
/// then undoes it: a stop before the drone is ready would have no effect. A replacement completes without us.
void SshEngine::await_starts(Clock::time_point until)
{
    for (auto& start : starts_)
        if (begun_.contains(start.drone))
            if (const auto result = start.command.poll(time_until(until)))
                static_cast<void>(report_of(start.drone, *result));
    starts_.clear();
}

std::vector<SwarmFailure> SshEngine::stop(const std::vector<std::string>& drones, Clock::time_point until)
{
    std::set<std::string> meant(drones.begin(), drones.end());
    std::erase_if(waiting_, [&](const SwarmDrone& drone) { return meant.contains(drone.name); });
    await_starts(until);
    std::erase_if(meant, [&](const std::string& name) { return !begun_.contains(name); });
    if (meant.empty())
        return {};
    std::vector<SwarmFailure> remains;
    if (stop_there({meant.begin(), meant.end()}, until))
        for (const auto& name : meant)  // stop them one by one, to see which one fails
            if (const auto error = stop_there({name}, until))
                remains.push_back({name, *error});
    for (const auto& name : meant)
        if (std::ranges::find(remains, name, &SwarmFailure::drone) == remains.end())
            begun_.erase(name);
    return remains;
}

std::optional<Error> SshEngine::stop_there(const std::vector<std::string>& drones, Clock::time_point until) const
try {
    until = std::min(until, Clock::now() + patience_to_stop);
    if (Clock::now() >= until)
        throw Error(Errc::timeout,
                    remote_.host() + " has not answered in time: whether " + drones.front() + " runs there is unknown",
                    "see there: ssh " + ssh_ + " hivectl ps");
    std::vector<std::string> words{"stop", "--json", "--timeout", std::to_string(seconds_until(until - 1s))};
    words.insert(words.end(), drones.begin(), drones.end());
    const auto result = remote_.hivectl(words, time_until(until));
    if (result.exit_code == 0 || (drones.size() == 1 && result.exit_code == not_found))
        return std::nullopt;
    return error_of(result);
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
