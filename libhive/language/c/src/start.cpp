// The functions that start and replace drones.
#include "application_object.hpp"
#include "own_timeout.hpp"
#include "texts.hpp"
#include "waiting.hpp"

#include <hive/start.hpp>

using namespace hive;
using namespace hive::c;

namespace {

using namespace std::chrono_literals;

SwarmDrone drone_of(const Options& given)
{
    SwarmDrone drone;
    drone.set = given.object("parameters");
    for (const auto& field : order_fields())
        if (field.option.empty())
            continue;
        else if (const auto* const key = field.name.data(); field.type == OrderField::Type::flag)
            field.set(drone, given.flag(key));
        else
            field.set(drone, given.text(key));
    return drone;
}

/// With the fields of an order.
Options given_options(const char* text, std::vector<const char*> known)
{
    known.insert(known.end(), {"parameters", "ready_ms"});
    for (const auto& field : order_fields())
        if (!field.option.empty())
            known.push_back(field.name.data());
    return {text, known};
}

StartOptions start_options(const Options& given)
{
    StartOptions options;
    options.drone = drone_of(given);
    options.limit = timeout_of(given.integer("ready_ms", 0, options.limit.count()));
    options.cancelled = wait_is_cancelled;
    return options;
}

void give_place(const Started& started, char** place)
{
    if (place)
        give_json(place_json(started.place), place);
}

}  // namespace

hive_code hive_application_start(hive_application* application, const char* kind, const char* options, char** place)
{
    return with_application(application, [&](Application& open) {
        const auto given = given_options(options, {"name", "ssh", "if_missing"});
        auto wanted = start_options(given);
        wanted.drone.kind = text_of(kind, "the kind");
        wanted.drone.name = given.text("name");
        wanted.ssh = given.text("ssh");
        wanted.if_missing = given.flag("if_missing");
        give_place(start(open, wanted), place);
    });
}

hive_code hive_application_replace(hive_application* application, const char* drone, const char* options, char** place)
{
    return with_application(application, [&](Application& open) {
        const auto given = given_options(options, {"kind", "lose_state", "force"});
        auto wanted = start_options(given);
        wanted.drone.name = text_of(drone, "the drone");
        wanted.drone.kind = given.text("kind");
        wanted.drone.lose_state = given.flag("lose_state");
        wanted.drone.force = given.flag("force");
        give_place(replace(open, wanted), place);
    });
}
