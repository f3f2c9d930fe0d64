// The functions of collectors.
#include "application_object.hpp"
#include "drone_object.hpp"
#include "texts.hpp"
#include "waiting.hpp"

#include <algorithm>

using namespace hive;
using namespace hive::c;

namespace {

using Clock = std::chrono::steady_clock;

/// Creates a collector and returns its handle.
void give_new(hive_application* application, hive_collector** place,
              const std::function<void(Application&, CollectorObject&)>& make)
{
    required(place, "the place for the collector");
    const auto object = get<ApplicationObject>(application);
    std::shared_ptr<CollectorObject> collector;
    object->with([&](Application& open) {
        collector = object->new_collector();
        make(open, *collector);
    });
    *place = give(std::move(collector));
}

std::vector<Endpoint> ends_of(Application& application, const char* outputs)
{
    std::vector<Endpoint> ends;
    for (const auto& text : names_of(required(outputs, "the outputs"), "the outputs"))
        ends.push_back(application.endpoint(text));
    if (ends.empty())
        throw Error(Errc::invalid_argument, "no outputs given");
    return ends;
}

std::optional<std::string> ended(const CollectorObject& collector)
{
    return collector.sets ? collector.sets->ended() : collector.events->ended();
}

/// Polls, letting other threads in between, until there is an event, the end, or the timeout.
template <class Take>
auto taken(CollectorObject& collector, int64_t timeout_ms, Take&& take)
{
    const auto end = Clock::now() + timeout_of(timeout_ms);
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
        decltype(take(std::chrono::milliseconds())) found;
        bool over = false;
        collector.application->with(collector, [&] {
            found = take(std::clamp<std::chrono::milliseconds>(left, std::chrono::milliseconds(0), longest_turn));
            over = !found && ended(collector);
        });
        if (found || over || Clock::now() >= end)
            return found;
        require_wait();
    }
}

Json counts_json(const CollectCounts& counts)
{
    return {{"received", counts.received},           {"duplicates", counts.duplicates}, {"missing", counts.missing},
            {"missing_turns", counts.missing_turns}, {"failed", counts.failed},         {"dropped", counts.dropped}};
}

/// Sets also have "sets".
Json all_counts(CollectorObject& collector)
{
    Json counts;
    collector.application->with(collector, [&] {
        counts = counts_json(collector.sets ? collector.sets->received() : collector.events->counts());
        if (!collector.sets)
            return;
        const auto sets = collector.sets->counts();
        counts["sets"] = {{"sets", sets.sets},
                          {"waiting", sets.waiting},
                          {"unmatched", sets.unmatched},
                          {"duplicates", sets.duplicates},
                          {"missing", sets.missing}};
    });
    return counts;
}

}  // namespace

hive_code hive_application_collect(hive_application* application, const char* outputs, const char* options,
                                   hive_collector** collector)
{
    return guarded([&] {
        const auto chosen = collect_options(options);
        give_new(application, collector, [&](Application& open, CollectorObject& made) {
            made.events = open.collect(ends_of(open, outputs), chosen);
        });
    });
}

hive_code hive_application_collect_matched(hive_application* application, const char* outputs, const char* match,
                                           const char* options, hive_collector** collector)
{
    return guarded([&] {
        const auto chosen = collect_options(options);
        const auto rule = match_of(match);
        give_new(application, collector, [&](Application& open, CollectorObject& made) {
            made.sets = open.collect_matched(ends_of(open, outputs), rule, chosen);
        });
    });
}

hive_code hive_application_exceptions(hive_application* application, const char* drones, hive_collector** collector)
{
    return guarded([&] {
        const auto names = names_of(required(drones, "the drones"), "the drones");
        give_new(application, collector,
                 [&](Application& open, CollectorObject& made) { made.events = open.exceptions(names); });
    });
}

hive_code hive_collector_next(hive_collector* collector, int64_t timeout_ms, hive_event** event)
{
    return guarded([&] {
        *required(event, "the place for the event") = nullptr;
        const auto object = get<CollectorObject>(collector);
        auto found = taken(*object, timeout_ms, [&](std::chrono::milliseconds timeout) {
            if (!object->events)
                throw Error(Errc::invalid_argument, "this collector gives sets: hive_collector_next_set()");
            return object->events->next(timeout);
        });
        if (found)
            *event = give(std::make_shared<EventObject>(std::move(*found)));
    });
}

hive_code hive_collector_next_set(hive_collector* collector, int64_t timeout_ms, hive_event** events, size_t capacity,
                                  size_t* count)
{
    return guarded([&] {
        *required(count, "the place for the count") = 0;
        required(events, "the place for the events");
        const auto object = get<CollectorObject>(collector);
        auto found = taken(*object, timeout_ms, [&](std::chrono::milliseconds timeout) {
            if (!object->sets)
                throw Error(Errc::invalid_argument, "this collector gives single events: hive_collector_next()");
            return object->sets->next(timeout);
        });
        if (!found)
            return;
        if (found->size() > capacity)
            throw Error(Errc::too_large, "a set has " + std::to_string(found->size()) + " events");
        for (auto& event : *found)
            events[(*count)++] = give(std::make_shared<EventObject>(std::move(event)));
    });
}

hive_code hive_collector_counts(hive_collector* collector, char** json, size_t* length)
{
    return guarded([&] { give_json(all_counts(*get<CollectorObject>(collector)), json, length); });
}

hive_code hive_collector_count(hive_collector* collector, const char* counter, int64_t* value)
{
    return guarded([&] {
        required(value, "the place for the value");
        const auto name = text_of(counter, "the counter");
        auto counts = all_counts(*get<CollectorObject>(collector));
        if (const Json sets = counts.value("sets", Json()); sets.is_object())
            for (const auto& [counter_of_sets, number] : sets.items())
                if (number.is_number_integer())
                    counts[counter_of_sets] =
                        number;  // for sets, "sets" is their number, and "missing" a list for each input
        const auto found = counts.find(name);
        if (found == counts.end() || !found->is_number_integer())
            throw Error(Errc::invalid_argument, "a collector has no counter " + in_quotes(name));
        *value = found->get<int64_t>();
    });
}

hive_code hive_collector_inputs(hive_collector* collector, char** json, size_t* length)
{
    return guarded([&] {
        const auto object = get<CollectorObject>(collector);
        Status status;  // which has them in the form of a drone's status
        object->application->with(
            *object, [&] { status.inputs = object->sets ? object->sets->inputs() : object->events->inputs(); });
        give_json(to_json(status).at("inputs"), json, length);
    });
}

hive_code hive_collector_ended(hive_collector* collector, bool* over, char** text)
{
    return guarded([&] {
        required(over, "the place for the answer");
        const auto object = get<CollectorObject>(collector);
        std::optional<std::string> said;
        object->application->with(*object, [&] { said = ended(*object); });
        *over = said.has_value();
        if (text && said)
            give_text(*said, text);
    });
}

hive_code hive_collector_close(hive_collector* collector)
{
    return guarded([&] {
        const auto object = get<CollectorObject>(collector);
        object->application->close(object);
    });
}
