// Application: finding, configuring, control.
#include "application_core.hpp"
#include "crashed_drones.hpp"
#include "joint_set.hpp"
#include "swarm/failed_drones.hpp"

#include <hive/event/failure_store.hpp>
#include <hive/event_text.hpp>
#include <hive/name.hpp>
#include <hive/protocol/requests.hpp>

#include <algorithm>
#include <set>

namespace hive {

using protocol::PacketType;

std::filesystem::path default_home() { return event::default_home(); }

Application::Application() : Application(Options{}) {}
Application::Application(Options options) : core_(std::make_unique<Core>(std::move(options))) {}
Application::~Application() = default;

const std::string& Application::name() const { return core_->module.self().name; }
const std::filesystem::path& Application::home() const { return core_->directory.home().directory(); }
void Application::timeout(std::chrono::milliseconds timeout) { core_->timeout = timeout; }

std::vector<std::string> Application::drones() { return core_->directory.names(); }
Place Application::place(const std::string& drone) { return core_->place(drone); }
std::vector<Place> Application::listed_places() { return core_->directory.list().places(); }
void Application::add_place(const Place& place) { core_->directory.list().add(place); }
void Application::replace_places(const std::vector<Place>& places) { core_->directory.list().replace(places); }
bool Application::forget_place(const Place& place) { return core_->directory.list().forget(place); }
std::vector<std::string> Application::remembered() { return core_->remembered(); }

std::vector<FailedDrone> Application::failed()
{
    const swarm::FailedDrones remembered(home());
    auto all = remembered.all();
    std::erase_if(all, [&](const FailedDrone& failed) {
        return core_->directory.home().alive(failed.drone) && remembered.forget(failed.drone);
    });
    return all;
}

std::vector<CrashedDrone> Application::crashed() { return crashed_drones(core_->directory.home()); }

std::vector<KeptFailure> Application::failures(const std::string& drone, bool bodies)
{
    return event::FailureStore(core_->directory.home()).read(drone, bodies);
}

/// A sender keeps the failure once the connection ends, after the crash, and knows when the process started.
std::optional<KeptFailure> Application::failure_of(const CrashedDrone& crash)
{
    constexpr std::int64_t second_us = 1'000'000;
    auto failures = this->failures(crash.drone);
    const auto found = std::ranges::find_if(failures, [&](const KeptFailure& failure) {
        return failure.code == "died" && failure.run <= crash.time_us && failure.time_us >= crash.time_us - second_us;
    });
    return found == failures.end() ? std::nullopt : std::optional(std::move(*found));
}

std::vector<std::string> Application::failing() { return event::FailureStore(core_->directory.home()).drones(); }

std::vector<std::string> Application::find(const std::string& pattern)
{
    if (pattern.find_first_of("*?") == std::string::npos) {
        core_->place(pattern);
        return {pattern};
    }
    auto names = core_->directory.names();
    std::erase_if(names, [&](const std::string& name) { return !matches_glob(pattern, name); });
    if (names.empty())
        throw Error(Errc::not_found, "no drone matches " + in_quotes(pattern));
    return names;
}

Endpoint Application::endpoint(const std::string& text)
{
    auto with_port = parse_endpoint(text);
    auto& directory = core_->directory;
    if (with_port.port.empty() || directory.find_known(text)
        || (!directory.find_known(with_port.drone) && directory.find(text)))
        return {text, ""};  // the network is queried only if no nearer drone matches
    return with_port;
}

Interface Application::describe(const std::string& drone)
{
    return interface_from_json(core_->ask(drone, PacketType::describe));
}

namespace {

/// The parameters in the answer of a drone. Any other answer is malformed.
Json parameters_in(const std::string& drone, Json result)
{
    static_cast<void>(Fields(result, "the answer of " + drone).object("parameters"));
    return std::move(result["parameters"]);
}

/// Reduces each answer to its parameters.
void keep_parameters(std::vector<Answer>& answers)
{
    for (auto& answer : answers)
        try {
            if (auto* result = std::get_if<Json>(&answer.result))
                answer.result = parameters_in(answer.drone, std::move(*result));
        } catch (const Error& error) {
            answer.result = error;
        }
}

/// Counts a set even if no answer arrived: the drone may have applied it.
struct CountedSet {
    std::atomic<std::int64_t>& sets;
    ~CountedSet() { ++sets; }
};

}  // namespace

Json Application::set(const std::string& drone, const Json& parameters)
{
    const auto until = core_->deadline();
    const CountedSet counted{core_->sets};
    try {
        return parameters_in(drone, core_->ask(drone, PacketType::set, {{"parameters", parameters}}));
    } catch (const Error& error) {
        if (error.code() != Errc::timeout || event::Clock::now() < until)
            throw;
        throw Error(Errc::timeout, drone + ": timed out; it may have the old or the new values");
    }
}

SetResult Application::set(const std::vector<std::string>& drones, const Json& parameters,
                           const std::function<bool()>& cancelled)
{
    const CountedSet counted{core_->sets};
    const auto either = [&] { return cancelled() || (core_->cancelled && core_->cancelled()); };
    JointSet::Terms terms{.drones = {}, .parameters = parameters, .deadline = core_->deadline(), .cancelled = either};
    auto places = core_->places_or_errors(drones);
    for (std::size_t i = 0; i < drones.size(); ++i)
        terms.drones.emplace_back(drones[i], std::move(places[i]));
    return JointSet(core_->module, std::move(terms)).run();
}

Json Application::get(const std::string& drone, const std::vector<std::string>& names)
{
    return parameters_in(drone, core_->ask(drone, PacketType::get, to_json(protocol::Get{.names = names})));
}

std::vector<Answer> Application::get(const std::vector<std::string>& drones, const std::vector<std::string>& names)
{
    auto answers = core_->ask_all(drones, PacketType::get, to_json(protocol::Get{.names = names}));
    keep_parameters(answers);
    return answers;
}

std::vector<Answer> Application::asked(const std::vector<std::string>& drones)
{
    auto answers = core_->ask_all(drones, PacketType::get, to_json(protocol::Get{.asked = true}));
    keep_parameters(answers);
    return answers;
}

void Application::put(const Endpoint& input, const Json& header, Body body, const std::string& type)
{
    std::string name = input.port;
    if (name.empty()) {
        const auto inputs = describe(input.drone).inputs;
        name = port_meant(inputs, input.drone, "input", "that takes " + type, [&](const Port& port) {
                   return types_fit(type, port.type);
               }).name;
    }
    core_->ask(input.drone, PacketType::put, to_json(protocol::Put{.input = name, .type = type, .header = header}),
               body);
}

void Application::put(const Endpoint& input, const Event& event)
{
    Json fields = parse_json(event_text(event));
    fields.erase("lossless");
    fields.erase("shares");
    fields["input"] = input.port;
    core_->ask(input.drone, PacketType::put, fields, event.body);
}

void Application::halt(const std::string& drone) { core_->ask(drone, PacketType::halt); }
void Application::resume(const std::string& drone) { core_->ask(drone, PacketType::resume); }
void Application::exception_policy(const std::string& drone, ExceptionPolicy policy)
{
    core_->ask(drone, PacketType::halt, {{"policy", token(policy)}});
}

void Application::stop(const std::string& drone) { value_or_throw(stop(std::vector{drone}).at(0).result); }

namespace {

/// A stopped drone may exit before its answer is sent.
void forgive_haste(std::vector<Answer>& answers)
{
    for (auto& answer : answers)
        if (const auto* error = error_of(answer.result); error && error->code() == Errc::connection_lost)
            answer.result = Json();
}

/// May its process be killed? A drone of this machine that does not answer hangs or is exiting.
bool may_end(const Place& place, const Answer& answer)
{
    const auto* error = error_of(answer.result);
    return !error || (is_here(place) && (error->code() == Errc::timeout || error->code() == Errc::unreachable));
}

/// The saved state of a drone of this machine that hangs or crashed has the name of its swarm.
bool is_of_another_swarm(const event::Home& home, const std::string& drone, const std::string& swarm)
try {
    const auto state = swarm.empty() ? std::nullopt : home.read_state(drone);
    return state && state->value("swarm", "") != swarm;
} catch (const std::exception&) {
    return false;  // unreadable
}

}  // namespace

std::vector<Answer> Application::stop(const std::vector<std::string>& drones, const std::string& swarm)
{
    return stop(drones, swarm, swarm.empty() ? Json::object() : Json{{"swarm", swarm}});
}

std::vector<Answer> Application::stop_to_restart(const std::vector<std::string>& drones)
{
    return stop(drones, "", {{"returns", true}});
}

std::vector<Answer> Application::stop(const std::vector<std::string>& drones, const std::string& swarm,
                                      const Json& header)
{
    const auto until = core_->deadline();
    std::vector<std::string> running;
    std::set<std::string> left_alone;
    const swarm::FailedDrones failed(home());
    for (const auto& drone : drones) {
        if (is_of_another_swarm(core_->directory.home(), drone, swarm)) {
            left_alone.insert(drone);
            continue;
        }
        const bool given_up = failed.forget(drone) && !core_->directory.home().alive(drone);
        if (core_->remembers(drone))
            core_->directory.home().forget_state(drone);
        else if (!given_up)
            running.push_back(drone);
    }
    const auto places = core_->places_or_errors(running);
    auto stopped = core_->ask_all(running, PacketType::stop, header);
    forgive_haste(stopped);
    std::vector<Answer> answers;
    for (std::size_t asked = 0; const auto& drone : drones) {
        const bool ran = asked < running.size() && running[asked] == drone;
        answers.push_back(ran ? std::move(stopped[asked]) : Answer{drone, {}});
        if (const auto* place = ran ? std::get_if<Place>(&places[asked]) : nullptr;
            place && may_end(*place, answers.back())) {
            auto& result = answers.back().result;
            if (const auto error = core_->wait_until_gone(*place, until))
                result = *error;
            else
                result = value_or_none(std::move(result));
        }
        asked += ran ? 1 : 0;
        if (left_alone.contains(drone))
            answers.back().result = Error(Errc::refused, drone + " was not brought up by the swarm " + swarm);
    }
    return answers;
}

}  // namespace hive
