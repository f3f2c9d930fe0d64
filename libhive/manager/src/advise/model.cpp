// The model: the rate of a stage is limited by its members, its connection and the processors of its machine.
#include "line.hpp"

#include <algorithm>
#include <cmath>

namespace hive::advising {
namespace {

constexpr double busy = 0.9;  ///< of the time: busy all the time

/// From one request of a member to its next, if it does not wait for an event.
double cycle_us(const Stage& stage) { return stage.round_trip_us + stage.encode_us + stage.transit_us + stage.work_us; }

bool streams(const Stage& stage) { return stage.options.transfer == Transfer::streaming; }

void add(std::vector<Station>& limits, Station::What what, std::string at, double time_us, double per_s)
{
    if (time_us > 0 && std::isfinite(time_us) && std::isfinite(per_s))
        limits.push_back({what, std::move(at), time_us, std::max(0.0, per_s)});
}

void add_limits(std::vector<Station>& limits, const Stage& stage)
{
    const double cycle = cycle_us(stage), path = cycle - stage.work_us;
    const double works = stage.share * stage.size() * second_us / stage.work_us;
    const double windowed = streams(stage) ? HUGE_VAL : stage.size() * stage.options.window * second_us / cycle;
    constexpr double small = 0.1;
    const bool is_overhead = path < small * cycle;  // then it belongs to the work
    add(limits, Station::What::work, names(stage), stage.work_us, is_overhead ? std::min(works, windowed) : works);
    add(limits, Station::What::encoding, connection(stage), stage.encode_us, second_us / stage.encode_us);
    if (stage.remote)
        add(limits, Station::What::travel, connection(stage), stage.transit_us, second_us / stage.transit_us);
    if (!is_overhead)
        add(limits, Station::What::window, connection(stage), path, windowed);
}

/// Processor time per event of the last stage on the machine, without the source, whose speed is given.
double cpu_per_event_us(const Line& line, const std::string& host)
{
    double sum = 0;
    for (std::size_t i = line.on_demand ? 0 : 1; i < line.stages.size(); ++i)
        if (const auto found = line.stages[i].hosts.find(host); found != line.stages[i].hosts.end())
            sum += line.stages[i].cpu_us * found->second / line.stages[i].size() / through(line, i);
    return sum;
}

/// Other processes keep the processors that they use, but the scheduler serves small users at once.
void add_limits(std::vector<Station>& limits, const Line& line)
{
    constexpr double little = 0.2;  // processors
    for (const auto& [host, machine] : line.machines)
        if (const double cost = cpu_per_event_us(line, host); machine.processors > 0)
            add(limits, Station::What::processors, host, cost,
                std::max(little, machine.processors - machine.others) * second_us / cost);
}

double source_per_s(const Line& line)
{
    const auto& source = line.stages.front();
    return !line.on_demand ? source.per_s : source.work_us > 0 ? second_us / source.work_us : HUGE_VAL;
}

/// The maximum rate of stage i alone.
double stage_per_s(const Stage& stage)
{
    std::vector<Station> limits;
    add_limits(limits, stage);
    double lowest = HUGE_VAL;
    for (const auto& limit : limits)
        lowest = std::min(lowest, limit.max_per_s);
    return lowest;
}

/// An event that ends just after the measurement is missing in the rate.
double one_event_per_s(const Line& line) { return line.time_us > 0 ? second_us / line.time_us : 0; }

/// Of a saturated stage: the time of an event on the connection besides the round trip and the encoding.
double saturated_transit_us(const Stage& stage, double one_event)
{
    const double cycle = stage.share * stage.size() * second_us / stage.per_s, window = stage.options.window;
    const double known = stage.round_trip_us + stage.encode_us + stage.work_us;
    if (!streams(stage) && stage.options.window == 1)
        return std::max(0.0, stage.share * stage.size() * second_us / (stage.per_s + stage.size() * one_event) - known);
    const bool works = stage.work_us >= busy * cycle, encodes = stage.encode_us * stage.per_s >= busy * second_us;
    if (works || encodes)
        return 0;
    constexpr double explained = 0.2;
    if (!streams(stage) && std::abs(window * cycle / known - 1) < explained)
        return std::max(0.0, window * cycle - known);
    return second_us / stage.per_s;  // the connection is full
}

/// From the emission of its event at the stage before to its own.
std::optional<double> between_us(const Line& line, std::size_t i)
{
    const auto &before = line.stages[i - 1].age_us, &after = line.stages[i].age_us;
    return before && after ? std::optional(std::max(0.0, *after - *before - line.stages[i].work_us)) : std::nullopt;
}

double one_way_us(const Stage& stage) { return stage.round_trip_us / 2 + stage.transit_us; }

}  // namespace

double through(const Line& line, std::size_t i)
{
    double passed = 1;
    for (i = std::max<std::size_t>(i, 1); i + 1 < line.stages.size(); ++i)
        passed *= line.stages[i].pass;
    return passed;
}

std::string names(const Stage& stage)
{
    std::string text;
    for (const auto& member : stage.members)
        text += (text.empty() ? "" : ", ") + member;
    return text;
}

std::string connection(const Stage& stage)
{
    return stage.from + " -> "
           + (stage.members.size() > 1 ? names(stage) + stage.to.substr(stage.to.rfind('.')) : stage.to);
}

void fit(Line& line)
{
    if (line.on_demand) {  // only the slowest has events that wait for it
        std::size_t slowest = 1;
        const auto load = [&](const Stage& stage) {
            return stage.per_s / stage.share * (stage.work_us + stage.round_trip_us / stage.options.window)
                   / stage.size();
        };
        for (std::size_t i = 1; i < line.stages.size(); ++i)
            slowest = load(line.stages[i]) > load(line.stages[slowest]) ? i : slowest;
        for (std::size_t i = 1; i < line.stages.size(); ++i)
            line.stages[i].saturated = i == slowest;
    }
    for (auto& [host, machine] : line.machines) {
        const double used = cpu_per_event_us(line, host) * line.per_s() / second_us;
        machine.others = std::clamp(std::min(machine.busy, machine.processors) - used, 0.0,
                                    std::max(0.0, machine.processors - used));
    }
    for (std::size_t i = 1; i < line.stages.size(); ++i) {
        auto& stage = line.stages[i];
        if (stage.per_s <= 0)
            continue;
        const auto between = between_us(line, i);
        if (stage.saturated)
            stage.transit_us = saturated_transit_us(stage, one_event_per_s(line));
        else if (between)
            stage.transit_us = std::max(0.0, *between - stage.queue_us - stage.round_trip_us / 2 - stage.encode_us);
    }
}

std::vector<Station> limits(const Line& line)
{
    std::vector<Station> limits;
    const auto source = source_per_s(line);
    add(limits, Station::What::source, line.stages.front().members.front(), second_us / source,
        source * through(line, 0));
    for (std::size_t i = 1; i < line.stages.size(); ++i) {
        std::vector<Station> own;
        add_limits(own, line.stages[i]);
        for (auto& limit : own) {
            limit.max_per_s *= through(line, i);
            limits.push_back(std::move(limit));
        }
    }
    add_limits(limits, line);
    std::ranges::stable_sort(limits, {}, &Station::max_per_s);
    return limits;
}

double rate(const Line& line)
{
    const auto all = limits(line);
    return all.empty() ? line.per_s() : all.front().max_per_s;
}

bool explains_rate(const Line& line)
{
    constexpr double fits = 1.15;
    return line.per_s() > 0
           && (rate(line) < fits * line.per_s() + one_event_per_s(line)
               || std::ranges::any_of(line.stages, &Stage::saturated));
}

double latency(const Line& line)
{
    double sum = 0, offered = source_per_s(line);
    for (std::size_t i = 1; i < line.stages.size(); ++i) {
        const auto& stage = line.stages[i];
        const double most = stage_per_s(stage), path = one_way_us(stage) + stage.encode_us;
        sum += path + stage.work_us;
        const bool saturated = most < offered;
        if (saturated && streams(stage))
            sum += std::max(0.0, between_us(line, i).value_or(stage.queue_us) - path);  // as long as its queue is
        else if (saturated)
            sum += second_us / offered / 2 + std::max(0.0, stage.options.window * stage.work_us - cycle_us(stage));
        offered = std::min(offered, most) * stage.pass;
    }
    return sum;
}

std::optional<double> measured_latency(const Line& line) { return line.last().age_us; }

std::vector<Station> stations(const Line& line)
{
    const auto& source = line.stages.front();
    std::vector<Station> way{
        {Station::What::source, names(source), source.per_s > 0 ? second_us / source.per_s : 0, 0}};
    for (std::size_t i = 1; i < line.stages.size(); ++i) {
        const auto& stage = line.stages[i];
        double left = between_us(line, i).value_or(one_way_us(stage) + stage.encode_us + stage.queue_us);
        const auto take = [&](double part) {
            part = std::min(part, left);
            left -= part;
            return part;
        };
        const double queue = take(stage.queue_us), encoding = take(stage.encode_us), travel = take(one_way_us(stage));
        const auto on = connection(stage);
        way.push_back({Station::What::waiting, on, left, 0});
        way.push_back({Station::What::encoding, on, encoding, 0});
        way.push_back({Station::What::travel, on, travel, 0});
        way.push_back({Station::What::queue, names(stage), queue, 0});
        way.push_back({Station::What::work, names(stage), stage.work_us, 0});
    }
    for (auto& station : way)
        for (const auto& limit : limits(line))
            if (limit.what == station.what && limit.at == station.at)
                station.max_per_s = limit.max_per_s;
    std::erase_if(way, [](const Station& station) { return station.time_us < 1; });
    return way;
}

}  // namespace hive::advising
