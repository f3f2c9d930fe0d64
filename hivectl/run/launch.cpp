// Messages of a verb while a drone starts, and once it is ready.
#include "run/launch.hpp"

#include "run/command_line.hpp"
#include "words/exit_code.hpp"
#include "run/interrupt.hpp"
#include "words/output.hpp"
#include "words/places.hpp"
#include "run/session.hpp"
#include "words/status_line.hpp"
#include "words/table.hpp"

namespace hivectl {

using namespace std::chrono_literals;

void declare_fields(CommandLine& line, hive::DroneOrder& order)
{
    for (const auto& field : hive::order_fields()) {
        const std::string option(field.option), help(field.help);
        if (option.empty())
            continue;
        if (field.type == hive::OrderField::Type::flag) {
            line.flag(option, order.*std::get<bool hive::DroneOrder::*>(field.member), help);
            continue;
        }
        const auto text = std::get<std::string hive::DroneOrder::*>(field.member);
        const auto declared = line.option(option, order.*text, help).type_name(std::string(field.placeholder));
        if (!field.words.empty())
            declared.one_of({field.words.begin(), field.words.end()});
    }
}

hive::StartOptions start_options(const Session& session, const std::string& verb, hive::DroneOrder drone,
                                 const std::string& on)
{
    const auto cancelled = [verb, on, name = drone.name] {
        if (interrupt::requested() && !on.empty())
            complain(verb, "interrupted: " + name + " is stopped as soon as " + on
                               + " has started it; Ctrl-C again leaves it there");
        return interrupt::requested();
    };
    return {.drone = std::move(drone),
            .ssh = on,
            .limit = session.timeout(10s),
            .cancelled = cancelled,
            .told = [verb](const std::string& text) { complain(verb, printable(text)); }};
}

int start_in_background(Session& session, const hive::StartOptions& options,
                        hive::Started (*start)(hive::Application&, hive::StartOptions))
{
    interrupt::defer_until_exit();  // an exit code of 130 would hide that the drone is running
    auto& application = session.application();
    std::optional<Waiting> waiting(options.drone.name + " to be ready" + (options.ssh.empty() ? "" : " on ")
                                   + options.ssh);
    const auto [place, log, found, before] = start(application, options);
    const auto status = application.status(place.drone + "@" + place.host);
    waiting.reset();
    Row row{
        {"drone", place.drone}, {"kind", status.kind}, {"pid", status.pid}, {"log", log}, {"places", status.places}};
    if (is_elsewhere(place)) {
        row.add("host", place.host);
        row.add("address", place.address);
    }
    if (found)
        row.add("found", true);
    if (before != 0)
        row.add("before", before);
    write_out(session.json ? row.json() + "\n" : place.drone + "\n");
    return exit_code::done;
}

hive::TiedDrone start_for_verb(Session& session, const std::string& verb, const hive::DroneOrder& drone)
{
    const Waiting waiting(drone.name + " to be ready");
    return {session.application(), start_options(session, verb, drone)};
}

}  // namespace hivectl
