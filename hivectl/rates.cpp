// Differences of counters, drone by drone and connection by connection.
#include "rates.hpp"

#include "connections.hpp"
#include "format.hpp"

#include <algorithm>

namespace hivectl {
namespace {

/// The status of a drone before, when it is the same run of it; otherwise nullptr.
const hive::Json* same_run(const std::vector<hive::Answer>& earlier, const hive::Answer& now)
{
    const auto found = std::ranges::find(earlier, now.drone, &hive::Answer::drone);
    const bool same =
        found != earlier.end() && !found->error && count_in(found->result, "epoch") == count_in(now.result, "epoch");
    return same ? &found->result : nullptr;
}

/// Events that its code has dealt with, well or not.
std::int64_t processed(const hive::Json& status)
{
    const auto& events = object_in(status, "events");
    return count_in(events, "processed") + count_in(events, "abandoned");
}

std::int64_t produced(const hive::Json& status)
{
    std::int64_t sum = 0;
    for (const auto& output : list_in(status, "outputs"))
        sum += count_in(output, "produced");
    return sum;
}

/// With the call that is under way.
std::int64_t busy(const hive::Json& status) { return count_in(status, "busy_us"); }

std::int64_t oldest_age(const hive::Json& status)
{
    std::int64_t age = 0;
    for (const auto& input : list_in(status, "inputs"))
        age = std::max(age, count_in(input, "last_age_us"));
    return age;
}

double per_second(std::int64_t count, std::chrono::nanoseconds interval)
{
    return static_cast<double>(count) / std::chrono::duration<double>(interval).count();
}

Row drone_row(const hive::Answer& now, const hive::Json* before, std::chrono::nanoseconds interval)
{
    Row row{{"name", now.drone}, {"state", now.error ? "silent" : text_in(now.result, "state")}};
    if (now.error || !before)
        return row;
    // By the drone's own clock, so that it does not matter when its answer came.
    const auto lived = std::max<std::int64_t>(1, count_in(now.result, "uptime_us") - count_in(*before, "uptime_us"));
    row.add("in_per_s", per_second(processed(now.result) - processed(*before), interval));
    row.add("out_per_s", per_second(produced(now.result) - produced(*before), interval));
    row.add("busy_percent",
            std::clamp(100.0 * static_cast<double>(busy(now.result) - busy(*before)) / static_cast<double>(lived), 0.0,
                       100.0));
    const auto age = oldest_age(now.result);
    return row.add("age_us", age > 0 ? hive::Json(age) : hive::Json());
}

/// Marks the busiest of those that processed something.
void mark_slowest(std::vector<Row>& rows)
{
    Row* slowest = nullptr;
    for (auto& row : rows)
        if (row.number("in_per_s") > 0 && (!slowest || row.number("busy_percent") > slowest->number("busy_percent")))
            slowest = &row;
    if (slowest)
        slowest->add("slowest", true);
}

/// A rate of one counter; null when the connection is new or began anew.
hive::Json rate(const Row* before, const Row& now, std::string_view key, std::chrono::nanoseconds interval)
{
    if (!before || (*before)[key].is_null() || now[key].is_null() || now.number(key) < before->number(key))
        return nullptr;
    return per_second(static_cast<std::int64_t>(now.number(key) - before->number(key)), interval);
}

Row edge_row(const Row* before, const Row& now, std::chrono::nanoseconds interval)
{
    Row row{{"from", now["from"]}, {"to", now["to"]}, {"state", now["state"]}};
    for (const std::string key : {"delivered", "skipped", "dropped", "abandoned"})
        row.add(key + "_per_s", rate(before, now, key, interval));
    return row.add("in_flight", now["in_flight"]).add("age_us", now["age_us"]);
}

std::string as_mark(const hive::Json& slowest) { return slowest == true ? "<- slowest" : ""; }

}  // namespace

Rates rates_between(const std::vector<hive::Answer>& earlier, const std::vector<hive::Answer>& now,
                    std::chrono::nanoseconds interval)
{
    Rates rates{interval, {}, {}};
    for (const auto& answer : now)
        rates.drones.push_back(drone_row(answer, same_run(earlier, answer), interval));
    mark_slowest(rates.drones);
    const auto before = connection_rows(earlier);
    for (const auto& row : connection_rows(now)) {
        const auto same = std::ranges::find_if(
            before, [&](const Row& old) { return old["from"] == row["from"] && old["to"] == row["to"]; });
        rates.edges.push_back(edge_row(same == before.end() ? nullptr : &*same, row, interval));
    }
    return rates;
}

std::vector<Column> drone_rate_columns()
{
    return {{"NAME", "name"},
            {"STATE", "state"},
            {"IN/s", "in_per_s", as_tenths},
            {"OUT/s", "out_per_s", as_tenths},
            {"BUSY", "busy_percent", as_percent},
            {"AGE", "age_us", as_duration},
            {"", "slowest", as_mark}};
}

std::vector<Column> edge_rate_columns()
{
    return {{"FROM", "from"},
            {"TO", "to"},
            {"STATE", "state"},
            {"DELIVERED/s", "delivered_per_s", as_tenths},
            {"SKIPPED/s", "skipped_per_s", as_tenths},
            {"DROPPED/s", "dropped_per_s", as_tenths},
            {"ABANDONED/s", "abandoned_per_s", as_tenths},
            {"IN-FLIGHT", "in_flight"},
            {"AGE", "age_us", as_duration}};
}

}  // namespace hivectl
