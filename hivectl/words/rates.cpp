// Computes differences of counters per drone and connection.
#include "words/rates.hpp"

#include "words/connections.hpp"
#include "words/format.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hivectl {
namespace {

/// The earlier status of a drone, if it is the same run; otherwise nullptr.
const hive::Status* same_run(const std::vector<hive::StatusAnswer>& earlier, const hive::StatusAnswer& now)
{
    const auto found = std::ranges::find(earlier, now.drone, &hive::StatusAnswer::drone);
    const auto *before = found == earlier.end() ? nullptr : value_of(found->status), *status = value_of(now.status);
    return before && status && before->epoch == status->epoch ? before : nullptr;
}

/// Events that its code has processed, with success or not.
std::int64_t processed(const hive::Status& status)
{
    std::int64_t sum = 0;
    for (const auto* rows : {&status.inputs, &status.left})
        for (const auto& input : *rows)
            sum += input.processed + input.abandoned;
    return sum;
}

/// Events that had a receiver.
std::int64_t sent(const hive::Status& status)
{
    std::int64_t sum = 0;
    for (const auto& output : status.outputs)
        sum += output.produced - output.unreceived;
    return sum;
}

std::int64_t oldest_age(const hive::Status& status)
{
    std::int64_t age = 0;
    for (const auto& input : status.inputs)
        age = std::max(age, input.last_age_us);
    return age;
}

double per_second(std::int64_t count, std::chrono::nanoseconds interval)
{
    return static_cast<double>(count) / std::chrono::duration<double>(interval).count();
}

Row drone_row(const hive::StatusAnswer& answer, const hive::Status* before, std::chrono::nanoseconds interval)
{
    const auto* status = value_of(answer.status);
    Row row{{"name", answer.drone}, {"state", status ? token(status->state) : "silent"}};
    if (!status || !before)
        return row;
    const auto& now = *status;
    // By the drone's own clock, so that the arrival time of its answer does not matter.
    const auto lived = std::max<std::int64_t>(1, now.uptime_us - before->uptime_us);
    row.add("in_per_s", per_second(processed(now) - processed(*before), interval));
    row.add("out_per_s", per_second(sent(now) - sent(*before), interval));
    row.add("busy_percent",
            std::clamp(100.0 * static_cast<double>(now.busy_us - before->busy_us) / static_cast<double>(lived), 0.0,
                       100.0));
    row.add("cpu_percent", 100.0 * static_cast<double>(now.cpu_us - before->cpu_us) / static_cast<double>(lived));
    row.add("memory", now.memory > 0 ? hive::Json(now.memory) : hive::Json());
    const auto age = oldest_age(now);
    return row.add("age_us", age > 0 ? hive::Json(age) : hive::Json());
}

/// Marks the busiest drone of those that processed events.
void mark_slowest(std::vector<Row>& rows)
{
    Row* slowest = nullptr;
    for (auto& row : rows)
        if (row.number("in_per_s") > 0 && (!slowest || row.number("busy_percent") > slowest->number("busy_percent")))
            slowest = &row;
    if (slowest)
        slowest->add("slowest", true);
}

/// The rate of one counter; null if the connection is new or was restarted.
hive::Json rate(const Row* before, const Row& now, std::string_view key, std::chrono::nanoseconds interval)
{
    if (!before || (*before)[key].is_null() || now[key].is_null() || now.number(key) < before->number(key))
        return nullptr;
    return per_second(static_cast<std::int64_t>(now.number(key) - before->number(key)), interval);
}

/// The counters of an edge that are shown as rates; the second half are losses.
constexpr std::array<std::string_view, 4> calm{"acknowledged", "skipped", "passed_on", "duplicates"};
constexpr std::array<std::string_view, 5> losses{"dropped", "abandoned", "lost", "dropped_by_receiver",
                                                 "abandoned_by_receiver"};

/// The clock offset if it is large; otherwise null.
hive::Json skew(const Row& edge)
{
    constexpr double noticeable_us = 100'000;
    return std::abs(edge.number("clock_offset_us")) > noticeable_us ? edge["clock_offset_us"] : hive::Json();
}

Row edge_row(const Row* before, const Row& now, std::chrono::nanoseconds interval)
{
    Row row{{"from", now["from"]}, {"to", now["to"]}, {"kind", now["kind"]}, {"state", now["state"]}};
    for (const auto key : calm)
        row.add(std::string(key) + "_per_s", rate(before, now, key, interval));
    bool losing = false;
    for (const auto key : losses) {
        const auto per_s = rate(before, now, key, interval);
        losing = losing || (per_s.is_number() && per_s > 0);
        row.add(std::string(key) + "_per_s", per_s);
    }
    for (const char* key : {"in_flight", "missing", "age_us", "why"})
        row.add(key, now[key]);
    row.add("skew_us", skew(now));
    return losing ? row.add("losing", true) : row;
}

/// The row of the same edge: receivers of one name are distinguished by their order.
const Row* earlier_row(const std::vector<Row>& before, const std::vector<Row>& now, const Row& row)
{
    const auto same = [&](const Row& other) { return other["from"] == row["from"] && other["to"] == row["to"]; };
    auto place = std::count_if(now.data(), &row, same);
    for (const auto& old : before)
        if (same(old) && place-- == 0)
            return &old;
    return nullptr;
}

std::string as_slowest(const hive::Json& slowest) { return slowest == true ? "<- slowest" : ""; }
std::string as_losing(const hive::Json& losing) { return losing == true ? "<- loses events" : ""; }

}  // namespace

Rates rates_between(const std::vector<hive::StatusAnswer>& earlier, const std::vector<hive::StatusAnswer>& now,
                    std::chrono::nanoseconds interval)
{
    Rates rates{interval, {}, {}};
    for (const auto& answer : now)
        rates.drones.push_back(drone_row(answer, same_run(earlier, answer), interval));
    mark_slowest(rates.drones);
    const auto before = connection_rows(earlier);
    const auto after = connection_rows(now);
    for (const auto& row : after)
        rates.edges.push_back(edge_row(earlier_row(before, after, row), row, interval));
    return rates;
}

std::vector<Column> drone_rate_columns()
{
    return {{"NAME", "name"},
            {"STATE", "state", nullptr, {}, state_colour},
            {"DONE", "done", nullptr, nothing},
            {"IN/s", "in_per_s", as_tenths},
            {"OUT/s", "out_per_s", as_tenths},
            {"BUSY", "busy_percent", as_percent},
            {"CPU", "cpu_percent", as_percent},
            {"MEMORY", "memory", as_size},
            {"AGE", "age_us", as_duration},
            {"", "slowest", as_slowest}};
}

std::vector<Column> edge_rate_columns()
{
    return {{"FROM", "from"},
            {"TO", "to"},
            {"KIND", "kind", nullptr, "receiver"},
            {"STATE", "state", nullptr, {}, state_colour},
            {"ACKNOWLEDGED/s", "acknowledged_per_s", as_tenths},
            {"SKIPPED/s", "skipped_per_s", as_tenths, nothing},
            {"PASSED-ON/s", "passed_on_per_s", as_tenths, nothing},
            {"DROPPED/s", "dropped_per_s", as_tenths, nothing, loss_colour},
            {"ABANDONED/s", "abandoned_per_s", as_tenths, nothing, loss_colour},
            {"LOST/s", "lost_per_s", as_tenths, nothing, loss_colour},
            {"R-DROPPED/s", "dropped_by_receiver_per_s", as_tenths, nothing, loss_colour},
            {"R-ABANDONED/s", "abandoned_by_receiver_per_s", as_tenths, nothing, loss_colour},
            {"DUPLICATES/s", "duplicates_per_s", as_tenths, nothing},
            {"IN-FLIGHT", "in_flight"},
            {"MISSING", "missing", nullptr, nothing, loss_colour},
            {"AGE", "age_us", as_duration},
            {"SKEW", "skew_us", as_duration, nothing},
            {"WHY", "why", nullptr, nothing},
            {"", "losing", as_losing, {}, loss_colour}};
}

}  // namespace hivectl
