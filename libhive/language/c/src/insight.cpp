// The functions explain, advise, audit, graph, metrics, failures and rerun.
#include "application_object.hpp"
#include "own_timeout.hpp"
#include "texts.hpp"
#include "waiting.hpp"

#include <hive/advise.hpp>
#include <hive/audit.hpp>
#include <hive/explain.hpp>
#include <hive/graph.hpp>
#include <hive/metrics.hpp>
#include <hive/rerun.hpp>

#include <algorithm>

using namespace hive;
using namespace hive::c;

namespace {

using namespace std::chrono_literals;

/// Returns the result of `look`. A drone that does not answer costs half a second, not the whole timeout.
template <class Look>
hive_code give_found(hive_application* application, char** json, size_t* length, const Look& look)
{
    return guarded([&] {
        const auto object = get<ApplicationObject>(application);
        object->with([&](Application& open) {
            const OwnTimeout looking(open, std::min<std::chrono::milliseconds>(500ms, object->timeout()),
                                     object->timeout());
            give_json(to_json(look(open)), json, length);
        });
    });
}

}  // namespace

hive_code hive_application_explain(hive_application* application, const char* outputs, char** json, size_t* length)
{
    return give_found(application, json, length, [&](Application& open) {
        if (outputs && *outputs == '{') {
            const Options pair(outputs, {"sender", "receiver"});
            const auto sender = pair.text("sender"), receiver = pair.text("receiver");
            if (sender.empty() || receiver.empty())
                throw Error(Errc::invalid_argument, "explain needs both, the sender and the receiver");
            return explain(open, open.endpoint(sender), open.endpoint(receiver));
        }
        std::vector<Endpoint> ends;
        for (const auto& text : names_of(required(outputs, "the outputs"), "the outputs"))
            ends.push_back(open.endpoint(text));
        return explain(open, ends);
    });
}

hive_code hive_application_advise(hive_application* application, const char* drones, const char* options, char** json,
                                  size_t* length)
{
    return give_found(application, json, length, [&](Application& open) {
        const Options given(options, {"goal", "time_ms"});
        const auto goal = given.text("goal");
        if (!goal.empty() && goal != token(Goal::fps) && goal != token(Goal::latency))
            throw Error(Errc::invalid_argument, "goal is \"fps\" or \"latency\"");
        return advise(open, names_of(required(drones, "the drones"), "the drones"),
                      {.goal = goal == token(Goal::latency) ? Goal::latency : Goal::fps,
                       .time = timeout_of(given.integer("time_ms", 1, 2000))});
    });
}

hive_code hive_application_audit(hive_application* application, char** json, size_t* length)
{
    return give_found(application, json, length, [](Application& open) { return audit(open); });
}

hive_code hive_application_graph(hive_application* application, char** json, size_t* length)
{
    return give_found(application, json, length, [](Application& open) { return graph(open); });
}

hive_code hive_application_metrics(hive_application* application, char** json, size_t* length)
{
    return give_found(application, json, length, [](Application& open) { return metrics(open); });
}

hive_code hive_application_failures(hive_application* application, const char* drone, char** json, size_t* length)
{
    return guarded([&] {
        get<ApplicationObject>(application)->with([&](Application& open) {
            Json found = Json::array();
            for (const auto& failure : open.failures(text_of(drone, "the drone")))
                found.push_back(to_json(failure));
            give_json(found, json, length);
        });
    });
}

hive_code hive_application_rerun(hive_application* application, const char* drone, int64_t number, const char* options,
                                 char** json, size_t* length)
{
    return guarded([&] {
        get<ApplicationObject>(application)->with([&](Application& open) {
            const auto name = text_of(drone, "the drone");
            const Options given(options, {"kind", "program", "parameters", "under", "limit_ms", "on"});
            const auto limit = timeout_of(given.integer("limit_ms", 0, 30'000));
            const auto failure = find_failure(open, {.drone = name,
                                                     .number = number,
                                                     .on = given.text("on"),
                                                     .limit = limit + 12s,
                                                     .cancelled = wait_is_cancelled});
            give_json(to_json(rerun(open, failure,
                                    {.kind = given.text("kind"),
                                     .program = given.text("program"),
                                     .set = given.object("parameters"),
                                     .under = given.texts("under"),
                                     .limit = limit,
                                     .cancelled = wait_is_cancelled})),
                      json, length);
        });
    });
}
