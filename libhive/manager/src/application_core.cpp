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
    throw Error(Errc::not_found, drone + " is not running; " + (near.empty() ? "start it: hivectl start " + drone : "did you mean " + near + "?"));
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
            answers.push_back({drones[i], {}, Error(error->code(), drones[i] + ": " + error->what())});
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
        throw Error(error->code(), drone + ": " + error->what());
    return std::get<Json>(outcome);
}

}  // namespace hive
