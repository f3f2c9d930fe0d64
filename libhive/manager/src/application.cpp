// The calls of an application: finding, configuring, control.
#include "application_core.hpp"
#include "joint_set.hpp"

#include <hive/name.hpp>

#include <algorithm>
#include <thread>

namespace hive {

using protocol::PacketType;

std::filesystem::path default_home() { return event::default_home(); }

Application::Application() : Application(Options{}) {}
Application::Application(Options options) : core_(std::make_unique<Core>(std::move(options))) {}
Application::~Application() = default;

const std::string& Application::name() const { return core_->module.self().name; }
void Application::timeout(std::chrono::milliseconds timeout) { core_->timeout = timeout; }

std::vector<std::string> Application::drones() { return core_->directory.names(); }
Place Application::place(const std::string& drone) { return core_->place(drone); }
std::vector<Place> Application::listed_places() { return core_->directory.list().places(); }
void Application::add_place(const Place& place) { core_->directory.list().add(place); }
bool Application::forget_place(const Place& place) { return core_->directory.list().forget(place); }
std::vector<std::string> Application::remembered() { return core_->remembered(); }

std::vector<std::string> Application::find(const std::string& pattern)
{
    if (pattern.find_first_of("*?") == std::string::npos) {
        core_->place(pattern);
        return {pattern};
    }
    auto names = core_->directory.names();
    std::erase_if(names, [&](const std::string& name) { return !matches_glob(pattern, name); });
    if (names.empty())
        throw Error(Errc::not_found, "no drone that runs fits " + in_quotes(pattern));
    return names;
}

Endpoint Application::endpoint(const std::string& text)
{
    const auto dot = text.rfind('.');
    if (dot == std::string::npos || core_->directory.find(text))
        return {text, ""};
    return {text.substr(0, dot), text.substr(dot + 1)};
}

Interface Application::describe(const std::string& drone)
{
    return interface_from_json(core_->ask(drone, PacketType::describe));
}

namespace {

/// The parameters in the answer of a drone. One that answers something else is malformed.
Json parameters_in(const std::string& drone, const Json& result)
{
    return Fields(result, "the answer of " + drone).object("parameters");
}

/// Leaves of each answer its parameters alone.
void keep_parameters(std::vector<Answer>& answers)
{
    for (auto& answer : answers)
        try {
            if (!answer.error)
                answer.result = parameters_in(answer.drone, answer.result);
        } catch (const Error& error) {
            answer.error = error;
        }
}

}  // namespace

Json Application::set(const std::string& drone, const Json& parameters)
{
    const auto until = core_->deadline();
    try {
        return parameters_in(drone,
                             core_->ask(drone, PacketType::set,
                                        {{"parameters", parameters}, {"deadline_ms", deadline_ms_before(until)}}));
    } catch (const Error& error) {
        if (error.code() != Errc::timeout || event::Clock::now() < until)
            throw;
        throw Error(Errc::timeout, drone + ": unknown whether it has the new values: no answer came in time");
    }
}

SetResult Application::set(const std::vector<std::string>& drones, const Json& parameters,
                           const std::function<bool()>& cancelled)
{
    JointSet::Terms terms{
        .drones = {}, .parameters = parameters, .deadline = core_->deadline(), .cancelled = cancelled};
    for (const auto& drone : drones)
        terms.drones.emplace_back(drone, core_->place_or_error(drone));
    return JointSet(core_->module, std::move(terms)).run();
}

Json Application::get(const std::string& drone, const std::vector<std::string>& names)
{
    return parameters_in(drone, core_->ask(drone, PacketType::get, {{"names", names}}));
}

std::vector<Answer> Application::get(const std::vector<std::string>& drones, const std::vector<std::string>& names)
{
    auto answers = core_->ask_all(drones, PacketType::get, Json{{"names", names}});
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
    core_->ask(input.drone, PacketType::put, {{"input", name}, {"type", type}, {"header", header}}, body);
}

void Application::halt(const std::string& drone) { core_->ask(drone, PacketType::halt); }
void Application::resume(const std::string& drone) { core_->ask(drone, PacketType::resume); }
void Application::exception_policy(const std::string& drone, ExceptionPolicy policy)
{
    core_->ask(drone, PacketType::halt, {{"policy", token(policy)}});
}

void Application::stop(const std::string& drone)
{
    if (core_->remembers(drone))
        return core_->directory.home().forget_state(drone);
    const auto until = core_->deadline();
    const auto place = core_->place(drone);
    try {
        core_->ask(drone, PacketType::stop);
    } catch (const Error& error) {
        if (error.code() != Errc::connection_lost)
            throw;  // it may be gone before its answer is
    }
    while (core_->answers(place)) {
        if (event::Clock::now() >= until)
            throw Error(Errc::timeout, drone + " was told to stop and still runs");
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (!is_here(place))
        core_->directory.list().forget(place);
}

}  // namespace hive
