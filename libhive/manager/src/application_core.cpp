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

std::optional<Error> met_another(const Place& place, const event::Link& link)
{
    if (is_here(place) || link.peer().name == place.drone)
        return std::nullopt;
    return Error(Errc::unreachable, "at " + place.address + " is " + link.peer().name + ", and not " + place.drone,
                 "strike it off the list: hivectl place remove " + place.drone);
}

Application::Core::Core(Application::Options options)
    : timeout(options.timeout),
      advice_if_missing(std::move(options.advice_if_missing)),
      directory(options.home.empty() ? default_home() : options.home),
      module({.self = {.name = name_of(options), .kind = "application", .epoch = event::wall_us(), .pid = ::getpid()},
              .limits = {},
              .timing = {},
              .keys = keys_of(options)})
{
    module.start();
}

bool Application::Core::remembers(const std::string& drone) const
{
    std::error_code ignored;
    return is_name(drone) && std::filesystem::exists(directory.home().path(drone, ".state"), ignored)
           && !directory.home().alive(drone);
}

std::vector<std::string> Application::Core::remembered() const
{
    std::vector<std::string> names;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(directory.home().directory(), ignored))
        if (entry.path().extension() == ".state" && remembers(entry.path().stem().string()))
            names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    return names;
}

Place Application::Core::place(const std::string& drone) const
{
    if (auto found = directory.find(drone))
        return *std::move(found);
    require_name(drone_of(drone), "drone");
    throw not_running(drone);
}

std::variant<Place, Error> Application::Core::place_or_error(const std::string& drone) const
try {
    return place(drone);
} catch (const Error& error) {
    return error;
}

Error Application::Core::not_running(const std::string& drone) const
{
    return no_such(drone + " is not running", drone, directory.names(),
                   advice_if_missing ? advice_if_missing(drone) : "");
}

Application::Core::Reply Application::Core::send(const Place& place, protocol::PacketType type, const Json& header,
                                                 const Body& body)
{
    auto reply = std::make_shared<std::optional<event::Outcome>>();
    const auto ask = [this, place, type, header, body, until = deadline(), reply](const event::LinkPtr& link,
                                                                                  const Error& error) {
        if (!link) {
            *reply = error;
        } else if (auto wrong = met_another(place, *link)) {
            *reply = *std::move(wrong);
        } else {
            link->request(type, header, body, until, [reply](const event::Outcome& outcome) { *reply = outcome; });
            module.arm();
        }
    };
    module.loop().perform([this, address = transport::parse_address(place.address), until = deadline(), ask] {
        module.with_link(address, until, ask);
    });
    return reply;
}

const event::Outcome& Application::Core::wait_for(const Reply& reply)
{
    module.loop().wait(event::Clock::time_point::max(), [&] { return reply->has_value(); });
    return reply->value();
}

bool Application::Core::answers(const Place& place)
{
    if (is_here(place))
        return directory.home().alive(place.drone);
    const auto reply = send(place, protocol::PacketType::status, {{"skip_edges", max_json_integer}}, {});
    return !std::holds_alternative<Error>(wait_for(reply));
}

std::vector<Answer> Application::Core::ask_all(const std::vector<std::string>& drones, protocol::PacketType type,
                                               const std::vector<Json>& headers)
{
    std::vector<Reply> replies;
    for (std::size_t i = 0; i < drones.size(); ++i) {
        const auto found = place_or_error(drones[i]);
        if (const auto* place = std::get_if<Place>(&found))
            replies.push_back(send(*place, type, headers[i], {}));
        else
            replies.push_back(std::make_shared<std::optional<event::Outcome>>(std::get<Error>(found)));
    }
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
    const auto reply = send(place(drone), type, header, body);
    const auto& outcome = wait_for(reply);
    if (const auto* error = std::get_if<Error>(&outcome))
        throw named(drone, *error);
    return std::get<Json>(outcome);
}

Endpoint Application::Core::with_output(const Endpoint& end)
{
    place(end.drone);
    if (!end.port.empty())
        return end;
    const auto outputs = interface_from_json(ask(end.drone, protocol::PacketType::describe)).outputs;
    return {end.drone, port_meant(outputs, end.drone, "output", "", [](const Port&) { return true; }).name};
}

}  // namespace hive
