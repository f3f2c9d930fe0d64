#include "snapshot.hpp"

#include "layout.hpp"
#include "run/exception_json.hpp"
#include "words/connections.hpp"
#include "words/rates.hpp"

#include <algorithm>
#include <array>
#include <set>

namespace hivectl::dash {
namespace {

using hive::Json;

/// Does a source on demand produce for any receiver of this output? A live one emits without receivers, too.
bool waits_for_receiver(const hive::Status& status, const hive::OutputStatus& output)
{
    constexpr std::int64_t second_us = 1'000'000;
    if (output.why == hive::Reason::held || output.why == hive::Reason::watched)
        return true;
    const auto now_us = status.epoch + status.uptime_us;  // by the drone's own clock
    return (output.why == hive::Reason::no_receiver || output.produced == 0) && status.inputs.empty()
           && output.last_emitted_us < now_us - second_us;
}

/// The row of a drone on the page; unknown rates are null.
Json drone_row(const hive::StatusAnswer& answer, const Row& rates)
{
    const auto* error = error_of(answer.status);
    const auto status = value_or_none(answer.status);
    Json row{{"name", answer.drone},
             {"host", answer.place.host},
             {"kind", status.kind},
             {"state", error ? Json("silent") : rates["state"]},
             {"note", error ? error->what() : status.condition},
             {"in_per_s", rates["in_per_s"]},
             {"out_per_s", rates["out_per_s"]},
             {"busy_percent", rates["busy_percent"]},
             {"age_us", rates["age_us"]},
             {"slowest", rates["slowest"] == true},
             {"why", hive::token(status.why)},
             {"thrown", status.last_exception ? Json(status.last_exception->time_us) : Json()}};
    Json images = Json::array(), held = Json::array();
    for (const auto& output : status.outputs)
        if (output.type.find("image/") != std::string::npos)
            (waits_for_receiver(status, output) ? held : images).push_back(output.name);
    row["images"] = images;
    row["held"] = held;
    return row;
}

/// The row of an application, or of a drone that crashed.
Json row_without_status(const hive::GraphDrone& drone)
{
    return {{"name", drone.name}, {"host", drone.host},      {"kind", ""},           {"state", drone.state},
            {"note", drone.note}, {"images", Json::array()}, {"held", Json::array()}};
}

bool has_status(const Look& look, const std::string& drone)
{
    return std::ranges::find(look.answers, drone, &hive::StatusAnswer::drone) != look.answers.end();
}

Json edge_row(const hive::AuditRow& audited, const Row& rates, const Row& counts, const hive::SwarmGraph& graph)
{
    const auto& ends = audited.ends;
    const bool lossy = audited.lost() > 0;
    return {{"id", id_of(ends)},
            {"from", ends.from},
            {"to", ends.to},
            {"sender", owner_of(ends.from, graph)},
            {"receiver", owner_of(ends.to, graph)},
            {"group", ends.options().group},
            {"state", rates["state"]},
            {"per_s", rates["acknowledged_per_s"]},
            {"age_us", rates["age_us"]},
            {"why", counts["why"]},
            {"lost", audited.lost()},
            {"losing", rates["losing"] == true},
            {"verdict", !audited.differences.empty() ? "differs"
                        : lossy                      ? "lost"
                                                     : "ok"}};
}

Json object_of(const Row& row) { return Json::parse(row.json()); }

/// Load of all processors of a drone's machine, between two statuses. Null: unknown.
Json machine_busy_percent(const hive::StatusAnswer& answer, const std::vector<hive::StatusAnswer>& earlier)
{
    const auto found = std::ranges::find(earlier, answer.drone, &hive::StatusAnswer::drone);
    const auto* before = found == earlier.end() ? nullptr : value_of(found->status);
    const auto* now = value_of(answer.status);
    if (!before || !now || now->machine.processors == 0 || before->epoch != now->epoch
        || now->uptime_us <= before->uptime_us)
        return nullptr;
    const auto possible = static_cast<double>((now->uptime_us - before->uptime_us) * now->machine.processors);
    return std::min(100.0, 100.0 * static_cast<double>(now->machine.cpu_us - before->machine.cpu_us) / possible);
}

/// The machines, with their number of drones and processor load.
Json machines_of(const std::array<Look, 3>& looks)
{
    std::map<std::string, std::pair<int, Json>> machines;
    for (const auto& answer : looks[2].answers) {
        if (answer.place.host.empty())
            continue;
        auto& [count, busy] = machines[answer.place.host];
        ++count;
        if (auto percent = machine_busy_percent(answer, looks[1].answers); !percent.is_null())
            busy = std::move(percent);
    }
    Json rows = Json::array();
    for (const auto& [host, machine] : machines)
        rows.push_back({{"host", host}, {"drones", machine.first}, {"busy_percent", machine.second}});
    return rows;
}

/// Clocks of two machines, as their drones have measured them.
Json clocks_of(const std::vector<hive::StatusAnswer>& answers)
{
    std::map<std::pair<std::string, std::string>, std::int64_t> offsets;
    for (const auto& ends : hive::connection_ends(answers))
        if (ends.at_receiver && ends.at_receiver->round_trip_us > 0 && ends.from_host != ends.to_host)
            offsets[{ends.from_host, ends.to_host}] = ends.at_receiver->clock_offset_us;
    Json rows = Json::array();
    for (const auto& [hosts, offset] : offsets)
        rows.push_back({{"host", hosts.first}, {"against", hosts.second}, {"offset_us", offset}});
    return rows;
}

std::string verdict_of(const hive::Audit& audit)
{
    std::int64_t lost = 0, differs = 0;
    for (const auto& row : audit.rows) {
        lost += row.lost();
        differs += row.differences.empty() ? 0 : 1;
    }
    if (differs > 0)
        return std::to_string(differs) + (differs == 1 ? " connection differs" : " connections differ");
    if (lost > 0)
        return std::to_string(lost) + (lost == 1 ? " event lost" : " events lost");
    return "nothing lost";
}

}  // namespace

Snapshot snapshot_of(const std::array<Look, 3>& looks, const hive::SwarmGraph& graph)
{
    Snapshot snapshot{.look = looks[2]};
    const auto rates = rates_between(looks[1].answers, looks[2].answers,
                                     std::max(looks[2].at - looks[1].at, std::chrono::steady_clock::duration(1)));
    snapshot.drones = Json::array();
    for (std::size_t i = 0; i < rates.drones.size(); ++i)
        snapshot.drones.push_back(drone_row(looks[2].answers[i], rates.drones[i]));
    for (const auto& drone : graph.drones)
        if (!has_status(looks[2], drone.name))
            snapshot.drones.push_back(row_without_status(drone));
    std::set<std::string> there;
    for (const auto& ends : graph.connections)
        there.insert(id_of(ends));
    const auto audit = hive::audit(looks[0].answers, looks[1].answers, looks[2].answers);
    const auto counts = connection_rows(looks[2].answers);
    snapshot.edges = Json::array();
    for (std::size_t i = 0; i < audit.rows.size(); ++i) {
        const auto id = id_of(audit.rows[i].ends);
        if (audit.rows[i].ends.is_group() || !there.contains(id))
            continue;
        snapshot.edges.push_back(edge_row(audit.rows[i], rates.edges[i], counts[i], graph));
        snapshot.audit[id] = to_json(audit.rows[i]);
        snapshot.both[id] = object_of(counts[i]);
    }
    return snapshot;
}

Json bar_of(const std::array<Look, 3>& looks)
{
    const auto audit = hive::audit(looks[0].answers, looks[1].answers, looks[2].answers);
    return {{"clean", audit.clean()},
            {"verdict", verdict_of(audit)},
            {"silent", audit.silent},
            {"machines", machines_of(looks)},
            {"clocks", clocks_of(looks[2].answers)}};
}

void remember(std::map<std::string, Past>& past, const Snapshot& now)
{
    std::erase_if(past, [&](const auto& each) {
        return std::ranges::none_of(now.drones, [&](const Json& row) { return row.at("name") == each.first; });
    });
    for (std::size_t i = 0; i < now.look.answers.size(); ++i) {
        const auto& answer = now.look.answers[i];
        auto& kept = past[answer.drone];
        const auto number = [&](const char* key) {
            const auto& value = now.drones[i].at(key);
            return value.is_number() ? value.get<double>() : 0;
        };
        kept.samples.push_back({std::max(number("in_per_s"), number("out_per_s")), number("busy_percent")});
        if (kept.samples.size() > Past::samples_kept)
            kept.samples.pop_front();
        const auto* status = value_of(answer.status);
        if (!status || !status->last_exception
            || (!kept.exceptions.empty() && kept.exceptions.front().time_us == status->last_exception->time_us))
            continue;
        kept.exceptions.push_front(*status->last_exception);
        if (kept.exceptions.size() > Past::exceptions_kept)
            kept.exceptions.pop_back();
    }
}

Json drone_details(const Snapshot& snapshot, const std::string& drone)
{
    const auto row = std::ranges::find_if(snapshot.drones, [&](const Json& each) { return each.at("name") == drone; });
    if (row == snapshot.drones.end() || row->at("host") == "")
        return nullptr;
    const auto found = std::ranges::find(snapshot.look.answers, drone, &hive::StatusAnswer::drone);
    const auto status = found == snapshot.look.answers.end() ? hive::Status() : value_or_none(found->status);
    Json outputs = Json::array(), per_s = Json::array(), busy = Json::array(), exceptions = Json::array();
    for (const auto& output : status.outputs)
        outputs.push_back({{"name", output.name},
                           {"type", output.type},
                           {"produced", output.produced},
                           {"why", hive::token(output.why)}});
    if (const auto past = snapshot.past.find(drone); past != snapshot.past.end()) {
        for (const auto& sample : past->second.samples) {
            per_s.push_back(sample.per_s);
            busy.push_back(sample.busy_percent);
        }
        for (const auto& exception : past->second.exceptions)
            exceptions.push_back(exception_json(exception));
    }
    return {{"drone", *row},
            {"pid", status.pid},
            {"version", status.version},
            {"uptime_us", status.uptime_us},
            {"on_exception", hive::token(status.policy)},
            {"places", status.places},
            {"outputs", outputs},
            {"per_s", per_s},
            {"busy_percent", busy},
            {"exceptions", exceptions}};
}

Json edge_details(const Snapshot& snapshot, const std::string& id)
{
    const auto audit = snapshot.audit.find(id);
    if (audit == snapshot.audit.end())
        return nullptr;
    return {{"audit", audit->second}, {"counts", snapshot.both.at(id)}};
}

}  // namespace hivectl::dash
