// The counters cover all events; the headers have the times of each one.
#include "measure.hpp"

#include "../directory.hpp"
#include <hive/name.hpp>

#include <algorithm>
#include <set>
#include <tuple>

namespace hive::advising {
namespace {

using namespace std::chrono_literals;
using explaining::Look;
using Clock = std::chrono::steady_clock;

/// The measurements of the events of one output.
struct Seen {
    int events = 0, worked = 0;  ///< worked: those with a processing time
    Clock::time_point first{}, last{};
    double wait_us = 0, work_us = 0, age_us = 0, bytes = 0;  ///< sums; bytes: the greatest

    void add(const Event& event)
    {
        first = events++ == 0 ? event.received : first;
        last = event.received;
        if (!event.identity.hops.empty() && event.identity.hops.back().drone == event.sender) {
            wait_us += static_cast<double>(event.identity.hops.back().wait_us);
            work_us += static_cast<double>(event.identity.hops.back().work_us);
            ++worked;
        }
        age_us += static_cast<double>(event.age().count());
        bytes = std::max(bytes, event.sized ? static_cast<double>(event.size) : 0);
    }
    [[nodiscard]] bool enough() const { return events >= 3 && last > first; }
    [[nodiscard]] double mean(double sum) const { return sum / events; }
    [[nodiscard]] double per_s() const { return (events - 1) / std::chrono::duration<double>(last - first).count(); }
};

/// By "drone.output".
using AllSeen = std::map<std::string, Seen>;

struct Looks {
    Look before, after;

    /// Null: no answer, or restarted between the two statuses.
    [[nodiscard]] const Status* earlier(const StatusAnswer& now) const
    {
        const auto* found = before.find(now.drone);
        const auto *then = found ? value_of(found->status) : nullptr, *status = value_of(now.status);
        return then && status && then->epoch == status->epoch ? then : nullptr;
    }
};

double us_between(const Status& before, const Status& after)
{
    return static_cast<double>(std::max<std::int64_t>(1, after.uptime_us - before.uptime_us));
}

std::int64_t processed(const InputStatus& input) { return input.processed + input.abandoned; }

std::int64_t processed(const Status& status)
{
    std::int64_t sum = 0;
    for (const auto* rows : {&status.inputs, &status.left})
        for (const auto& input : *rows)
            sum += processed(input);
    return sum;
}

std::int64_t processed(const std::vector<const InputStatus*>& rows)
{
    std::int64_t sum = 0;
    for (const auto* row : rows)
        sum += processed(*row);
    return sum;
}

std::int64_t emitted(const Status& status, const std::string& port)
{
    const auto found = std::ranges::find(status.outputs, port, &OutputStatus::name);
    return found == status.outputs.end() ? 0 : found->produced;
}

double ratio(double sum, double count) { return count > 0 ? sum / count : 0; }

/// The output from which the next step receives; of the last one, the first that has emitted.
std::string output_of(const std::vector<Step>& way, std::size_t i, const Status& status)
{
    if (i + 1 < way.size())
        return parse_endpoint(way[i + 1].from).port;
    for (const auto& output : status.outputs)
        if (output.name != "exceptions" && output.produced > 0)
            return output.name;
    return {};
}

/// Of a drone that answers.
const Status& status_of(const Look& look, const std::string& drone)
{
    return std::get<Status>(look.find(drone)->status);
}

std::vector<Endpoint> outputs_of(const Look& look, const std::vector<std::vector<Step>>& ways)
{
    std::map<std::string, Endpoint> ends;
    for (const auto& way : ways)
        for (std::size_t i = 0; i < way.size(); ++i)
            for (const auto& member : way[i].members)
                if (const auto port = output_of(way, i, status_of(look, member)); !port.empty())
                    ends[member + "." + port] = {member, port};
    std::vector<Endpoint> outputs;
    for (const auto& [name, end] : ends)
        outputs.push_back(end);
    return outputs;
}

std::unique_ptr<Collector> watch(Application& application, const std::vector<Endpoint>& outputs)
{
    CollectOptions options;
    options.connection.delivery = Delivery::notification;
    return application.collect(outputs, options);
}

AllSeen seen_by(Collector& collector, std::chrono::milliseconds time)
{
    AllSeen seen;
    const auto end = Clock::now() + time;
    for (auto now = Clock::now(); now < end; now = Clock::now())
        if (const auto event = collector.next(std::chrono::ceil<std::chrono::milliseconds>(end - now)))
            seen[event->sender + "." + event->output].add(*event);
        else if (collector.ended())
            break;
    return seen;
}

const Seen* seen_of(const AllSeen& all, const Status& status, const std::string& port)
{
    const auto found = all.find(status.name + "." + port);
    return found != all.end() && found->second.enough() ? &found->second : nullptr;
}

/// Were the connections of a step the same at both statuses? Otherwise their counters start again in between.
void require_same(const std::string& drone, const Step& step, const std::vector<const InputStatus*>& before,
                  const std::vector<const InputStatus*>& now)
{
    const bool same = std::ranges::equal(before, now, [](const InputStatus* one, const InputStatus* other) {
        return one->from == other->from && one->registration == other->registration;
    });
    if (!same || (now.empty() && !step.from.empty()))
        throw Error(Errc::connection_lost, drone + " was connected again meanwhile", "try again");
}

/// Sums over the members, of which `stage_of` makes means.
void add_member(Stage& stage, double& processed_here, const Status& before, const Status& now, const Step& step,
                const Seen* seen, const std::string& port)
{
    const double time = us_between(before, now);
    const auto rows = inputs_of(now, step);
    const auto* row = rows.empty() ? nullptr : rows.front();
    require_same(now.name, step, inputs_of(before, step), rows);
    const auto done = static_cast<double>(row ? processed(rows) - processed(inputs_of(before, step))
                                              : emitted(now, port) - emitted(before, port));
    const auto all = row ? static_cast<double>(processed(now) - processed(before)) : done;
    double work = ratio(static_cast<double>(now.busy_us - before.busy_us), all);
    constexpr double alike = 0.1;  // counters cut off parts of the first and last event, headers do not
    if (seen && row && seen->worked > 0) {
        const double told = seen->work_us / seen->worked;
        work = std::abs(work - told) < std::max(alike * work, time / std::max(1.0, all) / all) ? told : work;
    }
    const double counted = done * second_us / time;
    const bool one_each = seen && std::abs(seen->per_s() / std::max(counted, 1e-9) - 1) < alike;
    stage.per_s += one_each ? seen->per_s() : counted;
    stage.pass += static_cast<double>(emitted(now, port) - emitted(before, port));
    stage.share += all;
    processed_here += done;
    stage.work_us += work;
    stage.cpu_us += ratio(static_cast<double>(now.cpu_us - before.cpu_us), all);
    if (!row)
        return;
    stage.queue_us += seen && seen->worked > 0 ? seen->wait_us / seen->worked : 0;
    stage.round_trip_us += static_cast<double>(row->round_trip_us);
    stage.options = row->options;
}

/// What the sender reports of the connection.
void add_sender(Stage& stage, const Status& before, const Status& now, const Step& step)
{
    double missed = 0, came = 0, encoded = 0;
    const auto member = stage.members.front();
    const auto *edge = edge_of(now, step, member), *earlier = edge_of(before, step, member);
    if (edge && earlier) {
        const auto grown = [&](Fate fate) {
            return static_cast<double>(edge->events.of(fate) - earlier->events.of(fate));
        };
        missed = grown(Fate::skipped) + grown(Fate::dropped);
        came = static_cast<double>(edge->events.total() - earlier->events.total());
        encoded = grown(Fate::acknowledged);
    }
    constexpr double noticeable = 0.02;
    stage.saturated = missed > noticeable * came;
    for (const auto& output : now.outputs)
        for (const auto& row : output.edges)
            if (row.connected && output.name == parse_endpoint(step.from).port
                && belongs_to(row.receiver, drone_of(member)))
                stage.encoding = row.encoding;
    if (!stage.encoding.empty() && stage.encoding != "raw")
        stage.encode_us = ratio(static_cast<double>(now.encoding_us - before.encoding_us), encoded);
}

/// Their ratio. Counters are read while an event is in progress, and two statuses not at one instant.
double part(double one, double other)
{
    constexpr double cut_off = 2, alike = 0.02;
    return other <= 0 || std::abs(one - other) <= cut_off + alike * other ? 1 : one / other;
}

Stage stage_of(const Looks& looks, const AllSeen& all, const std::vector<Step>& way, std::size_t i)
{
    const auto& step = way[i];
    Stage stage{.members = step.members, .pass = 0, .share = 0, .from = step.from};
    double ages = 0, aged = 0, done = 0;
    bool work_follows = false;  // the known age is that at arrival
    for (const auto& member : step.members) {
        const auto* found = looks.after.find(member);
        const auto* before = found ? looks.earlier(*found) : nullptr;
        if (!before)
            throw Error(Errc::unreachable, member + " does not answer any more, or was restarted", "try again");
        const auto& now = std::get<Status>(found->status);
        ++stage.hosts[found->place.host];
        if (stage.host.empty())
            stage.host = found->place.host;
        const auto port = output_of(way, i, now);
        const auto* seen = seen_of(all, now, port);
        add_member(stage, done, *before, now, step, seen, port);
        if (seen) {
            ages += seen->age_us;
            aged += seen->events;
            stage.bytes = std::max(stage.bytes, seen->bytes);
        } else if (const auto rows = inputs_of(now, step); !rows.empty() && rows.front()->last_age_us > 0) {
            ages += static_cast<double>(rows.front()->last_age_us);
            ++aged;
            work_follows = true;
        }
    }
    if (aged > 0)
        stage.age_us = ages / aged + (work_follows ? stage.work_us / stage.size() : 0);
    const bool is_between = !step.from.empty() && i + 1 < way.size();
    stage.pass = is_between ? part(stage.pass, done) : 1;
    stage.share = part(done, stage.share);
    for (auto* sum : {&stage.work_us, &stage.cpu_us, &stage.queue_us, &stage.round_trip_us})
        *sum /= stage.size();
    if (step.from.empty())
        return stage;
    const auto& receiver = *looks.after.find(step.members.front());
    const auto* sender = looks.after.find(parse_endpoint(step.from).drone);
    stage.to = receiver.drone + "." + step.input;
    stage.remote = stage.round_trip_us > 0 || sender->place.host != receiver.place.host;
    const auto* before = looks.earlier(*sender);
    if (before)
        add_sender(stage, *before, std::get<Status>(sender->status), step);
    return stage;
}

std::map<std::string, MachineLoad> machines_of(const Looks& looks, const std::vector<Step>& way)
{
    std::set<std::string> on_way;
    std::set<std::pair<std::string, std::int64_t>> processes;
    for (const auto& step : way)
        on_way.insert(step.members.begin(), step.members.end());
    std::map<std::string, MachineLoad> machines;
    for (const auto& answer : looks.after.answers) {
        const auto* before = looks.earlier(answer);
        const auto* now = value_of(answer.status);
        if (!before || !now || now->machine.processors == 0)
            continue;
        const double time = us_between(*before, *now);
        auto& machine = machines[answer.place.host];
        machine.processors = static_cast<double>(now->machine.processors);
        machine.ssh = answer.place.ssh;
        machine.busy = std::max(machine.busy, static_cast<double>(now->machine.cpu_us - before->machine.cpu_us) / time);
        const double own = static_cast<double>(now->cpu_us - before->cpu_us) / time;
        constexpr double noticeable = 0.05;
        if (!on_way.contains(answer.drone) && own > noticeable && processes.emplace(answer.place.host, now->pid).second)
            machine.drones[answer.drone] = own;
    }
    return machines;
}

/// Its status says so, since headers do not: a notification is a live event.
bool is_on_demand(const Status& source, const std::string& port)
{
    return std::ranges::any_of(source.outputs,
                               [&](const OutputStatus& output) { return output.name == port && output.lossless; });
}

void ask_interfaces(Application& application, const Looks& looks, Line& line)
{
    const auto& source = line.stages.front().members.front();
    const auto interface = application.describe(source);
    if (const auto* fps = interface.parameter("fps"); fps && !line.on_demand) {
        line.rate_parameter = "fps";
        if (fps->type == ParameterType::integer)
            line.rate_step = 1;
    }
    for (std::size_t i = 1; i < line.stages.size(); ++i) {
        auto& stage = line.stages[i];
        const auto& status = status_of(looks.after, stage.members.front());
        const auto inputs = std::ranges::count_if(status.inputs, &InputStatus::connected);
        stage.can_share = inputs == 1 && stage.options.transfer == Transfer::synchronized && status.order
                          && !application.describe(stage.members.front()).stateful;
    }
}

/// Measures the cost of JPEG on a few events.
std::optional<Encoded> try_jpeg(Application& application, const Stage& stage)
{
    constexpr int wanted = 3;
    const auto sender = parse_endpoint(stage.from).drone;
    const auto before = application.status(sender).encoding_us;
    CollectOptions options;
    options.connection.window = 1;
    options.connection.encoding = "jpeg";
    const auto collector = application.collect({{sender, parse_endpoint(stage.from).port}}, options);
    Encoded sum;
    int events = 0;
    for (const auto end = Clock::now() + 2s; events < wanted && Clock::now() < end;)
        if (const auto event = collector->next(100ms)) {
            ++events;
            sum.bytes += static_cast<double>(event->body.size());
        }
    if (events == 0)
        return std::nullopt;
    sum.encode_us = static_cast<double>(application.status(sender).encoding_us - before);
    return Encoded{sum.bytes / events, sum.encode_us / events};
}

/// Stages where raw images spend much of the time on a connection to another machine.
void try_encodings(Application& application, Line& line)
{
    constexpr double much = 0.2;
    for (std::size_t i = 1; i < line.stages.size(); ++i) {
        const auto& stage = line.stages[i];
        if (line.on_demand || !stage.remote || stage.encode_us > 0 || line.stages[i - 1].bytes <= 0
            || stage.transit_us < much * (stage.round_trip_us + stage.work_us + stage.transit_us))
            continue;
        const auto interface = application.describe(parse_endpoint(stage.from).drone);
        const auto* port = interface.output(parse_endpoint(stage.from).port);
        if (!port || std::ranges::find(port->encodings, std::string("jpeg"), &Encoding::word) == port->encodings.end())
            continue;
        if (const auto jpeg = try_jpeg(application, stage))
            line.as_jpeg[i] = *jpeg;
    }
}

Line line_of(Application& application, const Looks& looks, const AllSeen& seen, const std::vector<Step>& way,
             std::chrono::milliseconds time)
{
    Line line{.time_us = std::chrono::duration<double, std::micro>(time).count()};
    for (std::size_t i = 0; i < way.size(); ++i)
        line.stages.push_back(stage_of(looks, seen, way, i));
    for (std::size_t i = 1; i < line.stages.size(); ++i)
        line.stages[i].bytes = line.stages[i - 1].bytes;
    const auto& source = status_of(looks.after, way.front().members.front());
    line.on_demand = is_on_demand(source, output_of(way, 0, source));
    line.machines = machines_of(looks, way);
    fit(line);
    ask_interfaces(application, looks, line);
    try_encodings(application, line);
    return line;
}

/// "face@gpu1" may be "face", too.
void leave_each_once(Look& look)
{
    std::set<std::tuple<std::string, std::int64_t, std::int64_t>> met;
    std::erase_if(look.answers, [&](const StatusAnswer& answer) {
        const auto* status = value_of(answer.status);
        return status && !met.emplace(status->name, status->epoch, status->pid).second;
    });
}

}  // namespace

std::vector<Measured> measure(Application& application, const std::vector<std::string>& drones,
                              std::chrono::milliseconds time)
{
    auto names = application.drones();
    names.insert(names.end(), drones.begin(), drones.end());
    Looks looks{.before = explaining::look_from(application, names, explaining::status_by(application)), .after = {}};
    leave_each_once(looks.before);
    const auto ways = trace(looks.before, drones);
    if (ways.empty())
        return {};
    std::vector<std::string> answering;
    for (const auto& answer : looks.before.answers)
        if (value_of(answer.status))
            answering.push_back(answer.drone);
    const auto collector = watch(application, outputs_of(looks.before, ways));
    looks.before.answers = application.status(answering);
    const auto seen = seen_by(*collector, time);
    looks.after.answers = application.status(answering);
    std::vector<Measured> measured;
    for (const auto& way : ways)
        try {
            measured.push_back({way, line_of(application, looks, seen, way, time)});
        } catch (const Error&) {  // a drone that restarts repeatedly must not hide the other lines
            if (ways.size() == 1)
                throw;
        }
    return measured;
}

}  // namespace hive::advising
