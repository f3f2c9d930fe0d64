// Asking drones: one or many at once, each answer by a deadline.
#include "application_core.hpp"

#include <hive/name.hpp>

#include <algorithm>
#include <atomic>

#include <unistd.h>

namespace hive {
namespace {

/// Drones keep one account for each name, so no two applications have the same one, not even in one process.
std::string name_of(const Application::Options& options)
{
    static std::atomic<int> made = 0;
    if (!options.name.empty())
        return require_name(options.name, "application");
    const int number = ++made;
    return "app-" + std::to_string(::getpid()) + (number == 1 ? "" : "-" + std::to_string(number));
}

/// Nothing is read before a drone is dialed over tcp.
std::shared_ptr<transport::KeyRing> keys_of(const Application::Options& options)
{
    const auto file = options.key.empty() ? default_key_file() : options.key;
    return file.empty() ? nullptr : std::make_shared<transport::KeyRing>(file);
}

}  // namespace

Error named(const std::string& drone, const Error& error)
{
    const std::string text = error.what();
    return error.reworded(text.starts_with(drone) ? text : drone + ": " + text);
}

Application::Core::Core(Application::Options options)
    : timeout(options.timeout),
      advice_if_missing(std::move(options.advice_if_missing)),
      home(options.home.empty() ? default_home() : options.home),
      module({.self = {.name = name_of(options), .kind = "application", .epoch = event::wall_us(), .pid = ::getpid()},
              .limits = {},
              .timing = {},
              .keys = keys_of(options)})
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

bool Application::Core::remembers(const std::string& drone) const
{
    std::error_code ignored;
    return is_name(drone) && std::filesystem::exists(home.path(drone, ".state"), ignored) && !home.alive(drone);
}

std::vector<std::string> Application::Core::remembered() const
{
    std::vector<std::string> names;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(home.directory(), ignored))
        if (entry.path().extension() == ".state" && remembers(entry.path().stem().string()))
            names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    return names;
}

void Application::Core::require_running(const std::string& drone) const
{
    if (is_name(drone) && home.alive(drone))
        return;
    require_name(drone, "drone");
    throw not_running(drone);
}

Error Application::Core::not_running(const std::string& drone) const
{
    return no_such(drone + " is not running", drone, running(), advice_if_missing ? advice_if_missing(drone) : "");
}

Application::Core::Reply Application::Core::send(const std::string& drone, protocol::PacketType type,
                                                 const Json& header, const Body& body)
{
    auto reply = std::make_shared<std::optional<event::Outcome>>();
    module.loop().perform([this, address = home.address(drone), type, header, body, until = deadline(), reply] {
        module.request(address, type, header, body, until,
                       [reply](const event::Outcome& outcome) { *reply = outcome; });
    });
    return reply;
}

const event::Outcome& Application::Core::wait_for(const Reply& reply)
{
    module.loop().wait(event::Clock::time_point::max(), [&] { return reply->has_value(); });
    return reply->value();
}

std::vector<Answer> Application::Core::ask_all(const std::vector<std::string>& drones, protocol::PacketType type,
                                               const std::vector<Json>& headers)
{
    std::vector<Reply> replies;
    for (std::size_t i = 0; i < drones.size(); ++i)
        replies.push_back(send(drones[i], type, headers[i], {}));
    std::vector<Answer> answers;
    for (std::size_t i = 0; i < drones.size(); ++i) {
        const auto& outcome = wait_for(replies[i]);
        if (const auto* error = std::get_if<Error>(&outcome))
            answers.push_back({drones[i], {}, named(drones[i], *error)});
        else
            answers.push_back({drones[i], std::get<Json>(outcome), std::nullopt});
    }
    return answers;
}

std::vector<Answer> Application::Core::ask_all(const std::vector<std::string>& drones, protocol::PacketType type,
                                               const Json& header)
{
    return ask_all(drones, type, std::vector<Json>(drones.size(), header));
}

Json Application::Core::ask(const std::string& drone, protocol::PacketType type, const Json& header, const Body& body)
{
    require_running(drone);
    const auto reply = send(drone, type, header, body);
    const auto& outcome = wait_for(reply);
    if (const auto* error = std::get_if<Error>(&outcome))
        throw named(drone, *error);
    return std::get<Json>(outcome);
}

Endpoint Application::Core::with_output(const Endpoint& end)
{
    require_running(end.drone);
    if (!end.port.empty())
        return end;
    const auto outputs = interface_from_json(ask(end.drone, protocol::PacketType::describe)).outputs;
    return {end.drone, port_meant(outputs, end.drone, "output", "", [](const Port&) { return true; }).name};
}

}  // namespace hive
