// Runs drones on another machine over ssh: the hivectl there starts and stops them.
#include "ssh_session.hpp"
#include "ssh_silent.hpp"

#include <hive/failure.hpp>
#include <hive/remote.hpp>
#include <hive/transport/key.hpp>

#include <algorithm>
#include <list>
#include <set>

namespace hive {
namespace {

using namespace std::chrono_literals;

constexpr auto start_grace = 2s;  ///< more than a start there may take, so that its outcome arrives here
constexpr auto stop_timeout = 30s;
constexpr auto keys_timeout = 5s;

class SshEngine final : public Engine {
public:
    SshEngine(const std::string& ssh, const std::filesystem::path& home) : ssh_(ssh), remote_(ssh, home) {}

    std::vector<Report> poll() override;
    [[nodiscard]] std::vector<int> descriptors() override;
    void adopt(const std::vector<std::string>& drones) override { begun_.insert(drones.begin(), drones.end()); }
    void look_again(const std::string& drone, const Error& why) override { silent_.check(drone, why); }
    [[nodiscard]] Error explained(const Error& error) const override;
    std::vector<SwarmFailure> stop(const std::vector<std::string>& drones, Clock::time_point until) override;

private:
    [[nodiscard]] bool may_start() const;
    void start_next(std::vector<Report>& reports);
    Report report_of(const std::string& drone, const CommandResult& result);
    [[nodiscard]] std::optional<std::set<std::string>> keys_there() const;
    Place place_of(const std::string& drone, const Json& places);
    void await_starts(Clock::time_point until);
    [[nodiscard]] std::optional<Error> stop_there(const std::vector<std::string>& drones,
                                                  Clock::time_point until) const;

    std::string ssh_;
    Remote remote_;
    std::string address_;  ///< of the machine; empty: not known yet
    std::list<SshSession> starts_;
    SilentDrones silent_{remote_};
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

/// Adds a listening address, unless the plan has one.
std::vector<std::string> words_to_start(SwarmDrone drone, Engine::Clock::time_point until)
{
    if (drone.listen.empty())
        drone.listen = "tcp://0.0.0.0";
    return with_order({"start", drone.kind, "--as", drone.name, "--json", "--if-missing", "--timeout",
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
    if (drone.force)
        words.emplace_back("--force");
    drone.take_over_s = 0;
    return with_order(std::move(words), drone);
}

bool SshEngine::may_start() const
{
    return !waiting_.empty() && starts_.size() < (connected_ ? SshSession::max_of_connection : 1)
           && !SshSession::is_limit_reached();
}

std::vector<Engine::Report> SshEngine::poll()
{
    std::vector<Report> reports;
    std::erase_if(starts_, [&](SshSession& start) {
        const auto result = start.command.poll();
        if (result)
            reports.push_back(report_of(start.drone, *result));
        return result.has_value();
    });
    while (may_start())
        start_next(reports);
    silent_.poll(reports);
    return reports;
}

std::vector<int> SshEngine::descriptors()
{
    std::vector<int> all;
    for (const auto& start : starts_)
        std::ranges::copy(start.command.descriptors(), std::back_inserter(all));
    silent_.add_descriptors(all);
    return all;
}

void SshEngine::start_next(std::vector<Report>& reports)
{
    const auto drone = std::move(waiting_.front());
    waiting_.pop_front();
    try {
        starts_.emplace_back(
            drone.name, remote_.command(takes_over(drone) ? words_to_replace(drone) : words_to_start(drone, until_)),
            time_until(until_ + start_grace));
        if (!takes_over(drone))
            begun_.insert(drone.name);
    } catch (const Error& error) {
        reports.push_back({drone.name, error});
    }
}

Engine::Report SshEngine::report_of(const std::string& drone, const CommandResult& result)
try {
    if ((result.exit_code == Remote::ssh_failed && !connected_) || result.exit_code == Remote::no_hivectl)
        begun_.erase(drone);  // nothing was started; but an established connection may have ended after a start
    remote_.require_there(result);
    connected_ = true;
    if (result.exit_code == 0) {
        const Json started = parse_json(result.out);
        const Fields fields(started, "what hivectl start printed");
        const bool found = fields.flag_or("found", false);
        if (found)
            begun_.erase(drone);  // another user's, or of a killed hivectl: not ours to stop
        return {drone, Started{.place = place_of(drone, fields.array("places")),
                               .log = fields.text_or("log", ""),
                               .found = found,
                               .before = fields.integer_or("before", 0, max_json_integer, 0)}};
    }
    if (result.exit_code < 128)  // else a signal ended ssh
        begun_.erase(drone);     // the hivectl there has stopped it
    return {drone, explained(remote_.error_of(result))};
} catch (const Error& error) {
    return {drone, error};
}

/// The user's keys there, by id; nothing: unknown.
std::optional<std::set<std::string>> SshEngine::keys_there() const
try {
    const auto listed = remote_.hivectl({"key", "show", "--json"}, keys_timeout);
    std::set<std::string> ids;
    if (listed.exit_code == 0)
        for (const auto& key : parse_json(listed.out))
            ids.insert(Fields(key, "what hivectl key show printed").text("id"));
    return listed.exit_code == 0 || is_not_found(listed) ? std::optional(ids) : std::nullopt;
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
    forget_waiting(drones);
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
    until = std::min(until, Clock::now() + stop_timeout);
    if (Clock::now() >= until)
        throw Error(Errc::timeout,
                    remote_.host() + " has not answered in time: whether " + drones.front() + " runs there is unknown",
                    "see there: ssh " + ssh_ + " hivectl ps");
    std::vector<std::string> words{"stop", "--json", "--timeout", std::to_string(seconds_until(until - 1s))};
    words.insert(words.end(), drones.begin(), drones.end());
    const auto result = remote_.hivectl(words, time_until(until));
    if (result.exit_code == 0 || (drones.size() == 1 && is_not_found(result)))
        return std::nullopt;
    return remote_.error_of(result);
} catch (const Error& error) {
    return error;
}

}  // namespace

std::unique_ptr<Engine> make_ssh_engine(const Json& settings, const std::filesystem::path& home)
{
    if (!settings.is_string())
        throw Error(Errc::invalid_argument, "the engine ssh needs an ssh host name");
    return std::make_unique<SshEngine>(settings.get<std::string>(), home);
}

}  // namespace hive
