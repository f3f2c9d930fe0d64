// Why nothing comes from drones, whether anything was lost, and what a swarm is made of.
#include "application_object.hpp"
#include "own_timeout.hpp"
#include "texts.hpp"

#include <hive/audit.hpp>
#include <hive/explain.hpp>
#include <hive/graph.hpp>

using namespace hive;
using namespace hive::c;

namespace {

using namespace std::chrono_literals;

/// Gives what `look` finds. A drone that does not answer takes half a second of it, not all of the time.
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
        std::vector<Endpoint> ends;
        for (const auto& text : names_of(required(outputs, "the outputs"), "the outputs"))
            ends.push_back(open.endpoint(text));
        return explain(open, ends);
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
