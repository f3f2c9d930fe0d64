// A drone in the background, and why nothing comes from one.
#include "application_object.hpp"
#include "own_timeout.hpp"
#include "texts.hpp"
#include "waiting.hpp"

#include <hive/stall_search.hpp>
#include <hive/start.hpp>

using namespace hive;
using namespace hive::c;

namespace {

using namespace std::chrono_literals;

SwarmDrone drone_of(const char* kind, const Options& given)
{
    SwarmDrone drone;
    drone.kind = text_of(kind, "the kind");
    drone.name = given.text("name");
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

StartOptions start_options(const char* kind, const char* text)
{
    std::vector known{"name", "ssh", "parameters", "ready_ms", "if_missing"};
    for (const auto& field : order_fields())
        if (!field.option.empty())
            known.push_back(field.name.data());
    const Options given(text, known);
    StartOptions options;
    options.drone = drone_of(kind, given);
    options.ssh = given.text("ssh");
    options.if_missing = given.flag("if_missing");
    options.limit = patience_of(given.integer("ready_ms", 0, options.limit.count()));
    options.cancelled = wait_is_cancelled;
    return options;
}

std::string error_text(const Error& error)
{
    const std::string advice = error.advice().empty() ? std::string(info(error.code()).advice) : error.advice();
    return error.what() + (advice.empty() ? "" : "; " + advice);
}

}  // namespace

hive_code hive_application_start(hive_application* application, const char* kind, const char* options, char** place)
{
    return with_application(application, [&](Application& open) {
        const auto started = start(open, start_options(kind, options));
        if (place)
            give_json(place_json(started.place), place);
    });
}

hive_code hive_application_stall(hive_application* application, const char* outputs, char** json, size_t* length)
{
    return guarded([&] {
        const auto object = get<ApplicationObject>(application);
        object->with([&](Application& open) {
            const OwnTimeout looking(open, std::min<std::chrono::milliseconds>(500ms, object->timeout()),
                                     object->timeout());
            std::vector<Endpoint> ends;
            for (const auto& text : names_of(required(outputs, "the outputs"), "the outputs"))
                ends.push_back(open.endpoint(text));
            const auto stall = stall_behind(open, ends, error_text);
            give_json({{"text", stall.text}, {"held", stall.held}}, json, length);
        });
    });
}
