// Sends requests to drones, one or many at once, each with a deadline.
#include "application_core.hpp"

#include "joint_set.hpp"

#include <hive/name.hpp>
#include <hive/platform/process.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <set>
#include <string_view>

namespace hive {
namespace {

constexpr std::size_t asked_at_once = 256;
constexpr int max_of_one = 16;          ///< requests to one drone at once: it refuses more than 32 of one peer
constexpr std::size_t most_typed = 16;  ///< names that a person may have typed
constexpr std::array<std::string_view, 2> left_by_crash{".state", ".crash"};

/// A second one is answered as the first one would have been.
bool may_be_repeated(protocol::PacketType type)
{
    using enum protocol::PacketType;
    return type == get || type == describe || type == status || type == connect;
}

/// Drones keep counters per name, so every application has its own, even in one process.
std::string name_of(const Application::Options& options)
{
    static std::atomic<int> made = 0;
    if (!options.name.empty())
        return require_name(options.name, "application");
    const int number = ++made;
    return "app-" + std::to_string(platform::own_pid()) + (number == 1 ? "" : "-" + std::to_string(number));
}

/// How many connections it keeps to ask again, and dials at a time; other descriptors are for longer connections, logs
/// and processes. By default, a process may have 1,024.
std::pair<std::size_t, std::size_t> most_connections()
{
    const auto most = std::min<std::size_t>(platform::most_descriptors(), 1024);
    return {most / 4 * 3, most / 8};
}

/// During a replace no process listens for some milliseconds.
/// @param once  drones to be dialed once more: the new process may have begun to listen since the dial was refused
bool is_replaced(const event::Home& home, const transport::Address& address, std::set<std::string>& once)
{
    const auto drone = std::filesystem::path(address.host).stem().string();
    if (!is_name(drone) || address != home.address(drone))
        return false;
    if (home.succession(drone) || (home.alive(drone) && once.insert(drone).second))
        return true;
    once.erase(drone);
    return false;
}

/// The key file is read only when a drone is dialed over tcp.
std::shared_ptr<transport::KeyRing> keys_of(const Application::Options& options)
{
    const auto file = options.key.empty() ? default_key_file() : options.key;
    return file.empty() ? nullptr
                        : std::make_shared<transport::KeyRing>(file, !options.key.empty() || key_file_is_named());
}

}  // namespace

Error named(const std::string& drone, const Error& error)
{
    const std::string text = error.what();
    return error.reworded(text.starts_with(drone) ? text : drone + ": " + text);
}

std::optional<Error> wrong_peer(const Place& place, const event::Link& link)
{
    if (is_here(place) || link.peer().name == place.drone)
        return std::nullopt;
    return Error(Errc::unreachable, place.address + " is " + link.peer().name + ", not " + place.drone,
                 place.announced ? "" : "remove the entry: hivectl place remove " + place.drone);
}

Application::Core::Core(Application::Options options)
    : timeout(options.timeout),
      advice_if_missing(std::move(options.advice_if_missing)),
      cancelled(std::move(options.cancelled)),
      directory(options.home.empty() ? default_home() : options.home,
                options.key.empty() ? default_key_file() : options.key),
      module({.self = {.name = name_of(options),
                       .kind = "application",
                       .epoch = event::wall_us(),
                       .pid = platform::own_pid()},
              .limits = {},
              .timing = {},
              .keys = keys_of(options),
              .most_dialed = most_connections().first,
              .listens_soon = [this, once = std::set<std::string>()](
                                  const auto& address) mutable { return is_replaced(directory.home(), address, once); },
              .most_dialing = most_connections().second})
{
    module.start();
}

bool Application::Core::remembers(const std::string& drone) const
{
    std::error_code ignored;
    // In this order: a stopping drone discards its state first, then releases its name.
    return is_name(drone) && !directory.home().runs(drone) && std::ranges::any_of(left_by_crash, [&](auto ending) {
               return std::filesystem::exists(directory.home().path(drone, ending), ignored);
           });
}

std::vector<std::string> Application::Core::remembered() const
{
    std::set<std::string> names;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(directory.home().directory(), ignored))
        if (std::ranges::find(left_by_crash, entry.path().extension()) != left_by_crash.end()
            && remembers(entry.path().stem().string()))
            names.insert(entry.path().stem().string());
    return {names.begin(), names.end()};
}

Place Application::Core::place(const std::string& drone) const
{
    if (auto found = directory.find(drone))
        return *std::move(found);
    require_name(drone_of(drone), "drone");
    throw not_running(drone);
}

Result<Place> Application::Core::place_or_error(const std::string& drone) const
try {
    return place(drone);
} catch (const Error& error) {
    return error;
}

std::vector<Result<Place>> Application::Core::places_or_errors(const std::vector<std::string>& drones) const
{
    std::vector<Result<Place>> places;
    for (const auto& drone : drones)
        if (drones.size() <= most_typed)
            places.push_back(place_or_error(drone));
        else
            try {
                const auto found = directory.find(drone);
                places.push_back(found ? Result<Place>(*found) : Error(Errc::not_found, drone + " is not running"));
            } catch (const Error& error) {
                places.emplace_back(error);
            }
    return places;
}

Error Application::Core::not_running(const std::string& drone) const
{
    return no_such(drone + " is not running", drone, directory.names(),
                   advice_if_missing ? advice_if_missing(drone) : "");
}

/// One request to one drone, shared by the callbacks that wait for its answer.
struct Application::Core::Asking {
    Place place;
    protocol::PacketType type;
    Json header;
    Body body;
    event::Clock::time_point until;
    int attempts = 0;
    Reply reply = std::make_shared<std::optional<event::Outcome>>();
};

Application::Core::Reply Application::Core::send(const Place& place, protocol::PacketType type, const Json& header,
                                                 const Body& body, event::Clock::time_point until)
{
    const auto asking = std::make_shared<Asking>(Asking{place, type, header, body, until});
    module.loop().perform([this, asking] { begin(asking); });
    return asking->reply;
}

/// Again, if the connection was lost: a replaced process closes its connections, and so does a drone that has not heard
/// of this process for a while, as on a busy machine.
bool Application::Core::begin_again(const std::shared_ptr<Asking>& asking, const Error& error)
{
    constexpr int most_attempts = 5;
    const bool again = error.code() == Errc::connection_lost && ++asking->attempts < most_attempts;
    if (again)
        module.post([this, asking] { begin(asking); });
    return again;
}

void Application::Core::begin(const std::shared_ptr<Asking>& asking)
{
    module.with_link(transport::parse_address(asking->place.address), asking->until,
                     [this, asking](const Result<event::LinkPtr>& found) {
                         const auto link = value_or_none(found);
                         if (const auto* failure = error_of(found)) {
                             if (!begin_again(asking, *failure))
                                 *asking->reply = *failure;
                         } else if (auto wrong = wrong_peer(asking->place, *link)) {
                             *asking->reply = *std::move(wrong);
                         } else {
                             asking->header["deadline_ms"] = deadline_ms_before(asking->until);
                             link->request(asking->type, asking->header, asking->body, asking->until,
                                           [this, asking](event::Outcome outcome) {
                                               const auto* error = std::get_if<Error>(&outcome);
                                               if (!error || !may_be_repeated(asking->type)
                                                   || !begin_again(asking, *error))
                                                   *asking->reply = std::move(outcome);
                                           });
                             module.arm();
                         }
                     });
}

void Application::Core::require_not_cancelled() const
{
    if (cancelled && cancelled())
        throw Error(Errc::stopped, "cancelled while waiting for an answer; the outcome is unknown");
}

void Application::Core::wait(event::Clock::time_point deadline, const std::function<bool()>& done)
{
    constexpr std::chrono::milliseconds look_period(50);
    for (bool is_done = false; !is_done && event::Clock::now() < deadline;) {
        const auto until = cancelled ? std::min(deadline, event::Clock::now() + look_period) : deadline;
        module.loop().wait(until, [&] { return is_done = done(); });
        if (!is_done)
            require_not_cancelled();
    }
}

event::Outcome Application::Core::wait_for(const Reply& reply)
{
    wait(event::Clock::time_point::max(), [&] { return reply->has_value(); });
    return std::move(reply->value());
}

bool Application::Core::answers(const Place& place)
{
    if (is_here(place))
        return directory.home().alive(place.drone);
    const auto reply = send(place, protocol::PacketType::status, {{"skip", max_json_integer}}, {}, deadline());
    return !std::holds_alternative<Error>(wait_for(reply));
}

void Application::Core::kill(const std::string& drone) const
{
    if (const auto pid = directory.home().holder(drone); pid > 0 && directory.home().alive(drone))
        platform::kill_process(pid);
    directory.home().forget_state(drone);
}

std::optional<Error> Application::Core::wait_until_gone(const Place& place, event::Clock::time_point until)
{
    bool killed = false;
    while (answers(place)) {
        if (event::Clock::now() >= until && (killed || !is_here(place)))
            return Error(Errc::timeout, place.drone + " has not stopped yet");
        if (event::Clock::now() >= until) {
            kill(place.drone);
            killed = true;
            until = event::Clock::now() + std::chrono::seconds(1);
        }
        wait(event::Clock::now() + std::chrono::milliseconds(2), [] { return false; });
    }
    if (!is_here(place))
        directory.list().forget(place);
    return std::nullopt;
}

std::vector<Answer> Application::Core::ask_all(const std::vector<std::string>& drones, protocol::PacketType type,
                                               const std::vector<Json>& headers,
                                               const std::function<event::Clock::time_point(std::size_t)>& until)
{
    const auto places = places_or_errors(drones);
    std::vector<Reply> replies;
    std::vector<Answer> answers;
    std::map<std::string_view, int> in_progress;  // by drone
    for (std::size_t i = 0; i < drones.size(); ++i) {
        while (replies.size() < std::min(drones.size(), i + asked_at_once)) {
            const auto next = replies.size();
            if (in_progress[drones[next]] >= max_of_one)
                break;
            ++in_progress[drones[next]];
            if (const auto* place = std::get_if<Place>(&places[next]))
                replies.push_back(send(*place, type, headers[next], {}, until ? until(next) : deadline()));
            else
                replies.push_back(std::make_shared<std::optional<event::Outcome>>(std::get<Error>(places[next])));
        }
        auto outcome = wait_for(replies[i]);
        --in_progress[drones[i]];
        if (const auto* error = error_of(outcome))
            outcome = named(drones[i], *error);
        answers.push_back({drones[i], std::move(outcome)});
    }
    return answers;
}

std::vector<Answer> Application::Core::ask_all(const std::vector<std::string>& drones, protocol::PacketType type,
                                               const Json& header)
{
    return ask_all(drones, type, std::vector<Json>(drones.size(), header));
}

Json Application::Core::ask(const std::string& drone, protocol::PacketType type, const Json& header, const Body& body,
                            std::optional<event::Clock::time_point> until)
{
    auto outcome = wait_for(send(place(drone), type, header, body, until.value_or(deadline())));
    if (const auto* error = std::get_if<Error>(&outcome))
        throw named(drone, *error);
    return std::get<Json>(std::move(outcome));
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
