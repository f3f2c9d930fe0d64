// Asking drones: one or many at once, each answer by a deadline.
#include "application_core.hpp"

#include <hive/name.hpp>

#include <future>
#include <unistd.h>

namespace hive {
namespace {

std::string name_of(const Application::Options& options)
{
    return options.name.empty() ? "app-" + std::to_string(::getpid()) : require_name(options.name, "application");
}

/// A drone is often called after its kind: "face", "face-2".
std::string start_command(const std::string& drone)
{
    const auto dash = drone.rfind('-');
    const bool numbered = dash != std::string::npos && drone.find_first_not_of("0123456789", dash + 1) == std::string::npos;
    return "hivectl start " + (numbered ? drone.substr(0, dash) + " --as " + drone : drone);
}

/// The error of a drone, saying whose it is.
Error named(const std::string& drone, const Error& error)
{
    const std::string text = error.what();
    return {error.code(), text.starts_with(drone) ? text : drone + ": " + text};
}

}  // namespace

Application::Core::Core(Application::Options options)
    : timeout(options.timeout), home(options.home.empty() ? default_home() : options.home),
      module({.self = {.name = name_of(options), .kind = "application", .epoch = event::wall_us(), .pid = ::getpid()}, .limits = {}, .timing = {}})
{
    module.start();
}

std::vector<std::string> Application::Core::running() const
{
    std::vector<std::string> names;
    for (const auto& name : home.names())
        if (home.alive(name))
            names.push_back(name);
    return names;
}

void Application::Core::require_running(const std::string& drone) const
{
    if (is_name(drone) && home.alive(drone))
        return;
    require_name(drone, "drone");
    const auto near = nearest(drone, running());
    throw Error(Errc::not_found, drone + " is not running; " + (near.empty() ? "start it: " + start_command(drone) : "did you mean " + near + "?"));
}

std::future<event::Outcome> Application::Core::send(const std::string& drone, protocol::PacketType type, const Json& header, const Body& body)
{
    const auto promise = std::make_shared<std::promise<event::Outcome>>();
    module.post([this, address = home.address(drone), type, header, body, until = deadline(), promise] {
        module.request(address, type, header, body, until, [promise](const event::Outcome& outcome) { promise->set_value(outcome); });
    });
    return promise->get_future();  // its value comes by the deadline: the module sees to it
}

std::vector<Answer> Application::Core::ask_all(const std::vector<std::string>& drones, protocol::PacketType type, const std::vector<Json>& headers)
{
    std::vector<std::future<event::Outcome>> futures;
    for (std::size_t i = 0; i < drones.size(); ++i)
        futures.push_back(send(drones[i], type, headers[i], {}));
    std::vector<Answer> answers;
    for (std::size_t i = 0; i < drones.size(); ++i) {
        const auto outcome = futures[i].get();
        if (const auto* error = std::get_if<Error>(&outcome))
            answers.push_back({drones[i], {}, named(drones[i], *error)});
        else
            answers.push_back({drones[i], std::get<Json>(outcome), std::nullopt});
    }
    return answers;
}

std::vector<Answer> Application::Core::ask_all(const std::vector<std::string>& drones, protocol::PacketType type, const Json& header)
{
    return ask_all(drones, type, std::vector<Json>(drones.size(), header));
}

Json Application::Core::ask(const std::string& drone, protocol::PacketType type, const Json& header, const Body& body)
{
    require_running(drone);
    const auto outcome = send(drone, type, header, body).get();
    if (const auto* error = std::get_if<Error>(&outcome))
        throw named(drone, *error);
    return std::get<Json>(outcome);
}

}  // namespace hive
