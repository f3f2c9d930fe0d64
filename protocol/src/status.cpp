// The status of a drone to JSON and back. Omits numbers that are 0, empty texts and false flags.
#include <hive/error.hpp>
#include <hive/status.hpp>

#include <utility>

namespace hive {
namespace {

constexpr std::array reasons{
    std::pair{Reason::none, ""},
    std::pair{Reason::no_receiver, "no_receiver"},
    std::pair{Reason::not_asked, "not_asked"},
    std::pair{Reason::lane_full, "lane_full"},
    std::pair{Reason::held, "held"},
    std::pair{Reason::group_awaited, "group_awaited"},
    std::pair{Reason::place_kept, "place_kept"},
    std::pair{Reason::not_acknowledged, "not_acknowledged"},
    std::pair{Reason::lease_running, "lease_running"},
    std::pair{Reason::halted, "halted"},
    std::pair{Reason::backlog, "backlog"},
    std::pair{Reason::dialing, "dialing"},
    std::pair{Reason::refused, "refused"},
    std::pair{Reason::no_input, "no_input"},
    std::pair{Reason::source_ended, "source_ended"},
    std::pair{Reason::set_prepared, "set_prepared"},
    std::pair{Reason::watched, "watched"},
};

constexpr std::array<std::pair<Fate, const char*>, fates> fate_tokens{{
    {Fate::acknowledged, "acknowledged"},
    {Fate::skipped, "skipped"},
    {Fate::dropped, "dropped"},
    {Fate::passed_on, "passed_on"},
    {Fate::abandoned, "abandoned"},
    {Fate::lost_connection, "lost_connection"},
    {Fate::lost_killed, "lost_killed"},
    {Fate::lost_cut_off, "lost_cut_off"},
    {Fate::lost_left, "lost_left"},
}};

constexpr std::array edge_numbers{std::pair{"waiting", &EdgeStatus::waiting}, std::pair{"shared", &EdgeStatus::shared},
                                  std::pair{"fallback", &EdgeStatus::fallback},
                                  std::pair{"last_lost_us", &EdgeStatus::last_lost_us}};

constexpr std::array output_numbers{std::pair{"produced", &OutputStatus::produced},
                                    std::pair{"unreceived", &OutputStatus::unreceived},
                                    std::pair{"last_emitted_us", &OutputStatus::last_emitted_us}};

constexpr std::array input_counts{
    std::pair{"received", &InputStatus::received},   std::pair{"processed", &InputStatus::processed},
    std::pair{"abandoned", &InputStatus::abandoned}, std::pair{"duplicates", &InputStatus::duplicates},
    std::pair{"discarded", &InputStatus::discarded}, std::pair{"dropped", &InputStatus::dropped},
    std::pair{"unmatched", &InputStatus::unmatched}, std::pair{"queued", &InputStatus::queued},
    std::pair{"in_hand", &InputStatus::in_hand}};

constexpr std::array input_numbers{std::pair{"last_age_us", &InputStatus::last_age_us},
                                   std::pair{"round_trip_us", &InputStatus::round_trip_us},
                                   std::pair{"clock_offset_us", &InputStatus::clock_offset_us},
                                   std::pair{"registration", &InputStatus::registration},
                                   std::pair{"last_lost_us", &InputStatus::last_lost_us},
                                   std::pair{"work_p99_us", &InputStatus::work_p99_us},
                                   std::pair{"disconnected_us", &InputStatus::disconnected_us}};

constexpr std::array matching_numbers{
    std::pair{"sets", &MatchingStatus::sets}, std::pair{"waiting", &MatchingStatus::waiting},
    std::pair{"unmatched", &MatchingStatus::unmatched}, std::pair{"duplicates", &MatchingStatus::duplicates}};

constexpr std::array machine_numbers{
    std::pair{"processors", &MachineStatus::processors}, std::pair{"cpu_us", &MachineStatus::cpu_us},
    std::pair{"memory", &MachineStatus::memory}, std::pair{"memory_available", &MachineStatus::memory_available}};

constexpr std::array status_numbers{std::pair{"pid", &Status::pid},
                                    std::pair{"epoch", &Status::epoch},
                                    std::pair{"uptime_us", &Status::uptime_us},
                                    std::pair{"busy_us", &Status::busy_us},
                                    std::pair{"busy_for_us", &Status::busy_for_us},
                                    std::pair{"encoding_us", &Status::encoding_us},
                                    std::pair{"cpu_us", &Status::cpu_us},
                                    std::pair{"memory", &Status::memory},
                                    std::pair{"source_events", &Status::source_events},
                                    std::pair{"rows_left_out", &Status::rows_left_out}};

template <class Value, class Table>
void write_numbers(Json& json, const Value& value, const Table& table)
{
    for (const auto& [key, member] : table)
        if (value.*member != 0)
            json[key] = value.*member;
}

template <class Value, class Table>
void read_numbers(const Fields& fields, Value& value, const Table& table)
{
    for (const auto& [key, member] : table)
        value.*member = fields.integer_or(key, -max_json_integer, max_json_integer, 0);
}

void write_text(Json& json, const char* key, std::string_view text)
{
    if (!text.empty())
        json[key] = text;
}

void write_why(Json& json, Reason why) { write_text(json, "why", token(why)); }

/// A keyword of a newer drone that this reader does not know must not invalidate the rest.
Reason read_why(const Fields& fields)
{
    const auto word = fields.text_or("why", "");
    for (const auto& [reason, text] : reasons)
        if (word == text)
            return reason;
    return Reason::none;
}

template <class Item, class Read>
std::vector<Item> read_list(const Fields& fields, const char* key, Read read)
{
    std::vector<Item> items;
    if (fields.has(key))
        for (const auto& item : fields.array(key))
            items.push_back(read(item));
    return items;
}

template <class Item, class Write>
void write_list(Json& json, const char* key, const std::vector<Item>& items, Write write)
{
    json[key] = Json::array();
    for (const auto& item : items)
        json[key].push_back(write(item));
}

EdgeStatus edge_from_json(const Json& object)
{
    const Fields fields(object, "edge");
    EdgeStatus edge;
    edge.receiver = fields.text("receiver");
    edge.group = fields.flag_or("group", false);
    edge.connected = fields.flag_or("connected", false);
    edge.registration = fields.integer_or("registration", 0, max_json_integer, 0);
    if (fields.has("options"))
        edge.options = connection_options(fields.object("options"));
    edge.encoding = fields.text_or("encoding", "");
    edge.events.came(fields.integer_or("came", 0, max_json_integer, 0));
    for (const auto& [fate, key] : fate_tokens)
        edge.events.went(fate, fields.integer_or(key, 0, max_json_integer, 0));
    read_numbers(fields, edge, edge_numbers);
    edge.why = read_why(fields);
    return edge;
}

Json output_to_json(const OutputStatus& output)
{
    Json json{{"name", output.name}, {"type", output.type}, {"produced", 0}};
    write_numbers(json, output, output_numbers);
    if (output.lossless)
        json["lossless"] = true;
    write_list(json, "edges", output.edges, [](const EdgeStatus& edge) { return to_json(edge); });
    write_why(json, output.why);
    return json;
}

OutputStatus output_from_json(const Json& object)
{
    const Fields fields(object, "output");
    OutputStatus output;
    output.name = fields.name("name");
    output.type = fields.text_or("type", "");
    read_numbers(fields, output, output_numbers);
    output.lossless = fields.flag_or("lossless", false);
    output.edges = read_list<EdgeStatus>(fields, "edges", edge_from_json);
    output.why = read_why(fields);
    return output;
}

InputStatus input_from_json(const Json& object)
{
    const Fields fields(object, "input");
    InputStatus input;
    input.input = fields.name("input");
    input.from = fields.text_or("from", "");
    input.address = fields.text_or("address", "");
    input.kind = fields.text_or("kind", "");
    input.connected = fields.flag_or("connected", false);
    if (fields.has("options"))
        input.options = connection_options(fields.object("options"));
    read_numbers(fields, input, input_counts);
    read_numbers(fields, input, input_numbers);
    input.error = fields.text_or("error", "");
    input.why = read_why(fields);
    return input;
}

Json matching_to_json(const MatchingStatus& matching)
{
    Json json{{"inputs", matching.inputs}, {"missing", matching.missing}};
    write_numbers(json, matching, matching_numbers);
    return json;
}

MatchingStatus matching_from_json(const Json& object)
{
    const Fields fields(object, "matching");
    MatchingStatus matching;
    for (const auto& input : fields.array("inputs"))
        matching.inputs.push_back(input.is_string() ? input.get<std::string>() : "");
    if (fields.has("missing"))
        for (const auto& [input, count] : fields.object("missing").items())
            matching.missing[input] = json_integer(count).value_or(0);
    read_numbers(fields, matching, matching_numbers);
    return matching;
}

/// The sums over all inputs, for readers that skip the rows.
Json totals_to_json(const Status& status)
{
    InputStatus sum;
    for (const auto* rows : {&status.inputs, &status.left})
        for (const auto& row : *rows)
            for (const auto& [key, member] : input_counts)
                sum.*member += row.*member;
    Json json;
    for (const auto& [key, member] : input_counts)
        json[key] = sum.*member;
    return json;
}

Json exception_to_json(const ExceptionStatus& exception)
{
    return {{"code", exception.code},   {"text", exception.text},       {"policy", exception.policy},
            {"input", exception.input}, {"time_us", exception.time_us}, {"source", exception.source},
            {"seq", exception.sequence}};
}

ExceptionStatus exception_from_json(const Json& object)
{
    const Fields fields(object, "exception");
    ExceptionStatus exception;
    exception.code = fields.text_or("code", "");
    exception.text = fields.text_or("text", "");
    exception.policy = fields.text_or("policy", "");
    exception.input = fields.text_or("input", "");
    exception.time_us = fields.integer_or("time_us", 0, max_json_integer, 0);
    exception.source = fields.text_or("source", "");
    exception.sequence = fields.integer_or("seq", 0, max_json_integer, 0);
    return exception;
}

}  // namespace

std::string_view token(Reason value) noexcept
{
    for (const auto& [reason, text] : reasons)
        if (reason == value)
            return text;
    return {};
}

std::string_view token(Fate value) noexcept { return fate_tokens[static_cast<std::size_t>(value)].second; }

bool is_loss(Fate fate) noexcept
{
    return fate == Fate::dropped || fate == Fate::abandoned || fate == Fate::lost_connection
           || fate == Fate::lost_killed || fate == Fate::lost_cut_off;
}

std::int64_t Ledger::lost() const noexcept
{
    return of(Fate::lost_connection) + of(Fate::lost_killed) + of(Fate::lost_cut_off) + of(Fate::lost_left);
}

Json to_json(const EdgeStatus& edge)
{
    Json json{{"receiver", edge.receiver}, {"options", to_json(edge.options)}, {"came", edge.events.total()}};
    if (edge.group)
        json["group"] = true;
    if (edge.connected)
        json["connected"] = true;
    if (edge.registration != 0)
        json["registration"] = edge.registration;
    write_text(json, "encoding", edge.encoding);
    for (const auto& [fate, key] : fate_tokens)
        if (edge.events.of(fate) != 0)
            json[key] = edge.events.of(fate);
    if (edge.events.in_flight() != 0)
        json["in_flight"] = edge.events.in_flight();
    write_numbers(json, edge, edge_numbers);
    write_why(json, edge.why);
    return json;
}

Json to_json(const InputStatus& input)
{
    Json json{{"input", input.input}, {"options", to_json(input.options)}};
    write_text(json, "from", input.from);
    write_text(json, "address", input.address);
    write_text(json, "kind", input.kind);
    if (input.connected)
        json["connected"] = true;
    write_numbers(json, input, input_counts);
    write_numbers(json, input, input_numbers);
    write_text(json, "error", input.error);
    write_why(json, input.why);
    return json;
}

Json to_json(const Status& status)
{
    const auto row_to_json = [](const InputStatus& input) { return to_json(input); };
    Json json{
        {"name", status.name}, {"kind", status.kind}, {"state", token(status.state)}, {"policy", token(status.policy)}};
    write_numbers(json, status, status_numbers);
    if (status.machine.processors > 0)
        write_numbers(json["machine"], status.machine, machine_numbers);
    if (status.machine.memory_limited)
        json["machine"]["memory_limited"] = true;
    write_text(json, "condition", status.condition);
    write_text(json, "callback", status.callback);
    write_why(json, status.why);
    json["events"] = totals_to_json(status);
    write_list(json, "outputs", status.outputs, output_to_json);
    write_list(json, "inputs", status.inputs, row_to_json);
    if (!status.left.empty())
        write_list(json, "left", status.left, row_to_json);
    if (!status.matching.empty())
        write_list(json, "matching", status.matching, matching_to_json);
    if (status.last_exception)
        json["last_exception"] = exception_to_json(*status.last_exception);
    if (status.halted) {
        json["halted"]["time_us"] = status.halted->time_us;
        write_text(json["halted"], "by", status.halted->by);
    }
    if (!status.places.empty())
        json["places"] = status.places;
    write_text(json, "swarm", status.swarm);
    if (status.order)
        json["order"] = to_json(*status.order);
    write_text(json, "version", status.version);
    return json;
}

Status status_from_json(const Json& object)
{
    const Fields fields(object, "status");
    Status status;
    status.name = fields.name("name");
    status.kind = fields.name("kind");
    status.state = from_token<State>(fields.text("state"), "state");
    status.policy = from_token<ExceptionPolicy>(fields.text_or("policy", "skip"), "policy");
    read_numbers(fields, status, status_numbers);
    if (fields.has("machine")) {
        const Fields machine(fields.object("machine"), "machine");
        read_numbers(machine, status.machine, machine_numbers);
        status.machine.memory_limited = machine.flag_or("memory_limited", false);
    }
    status.condition = fields.text_or("condition", "");
    status.callback = fields.text_or("callback", "");
    status.why = read_why(fields);
    status.outputs = read_list<OutputStatus>(fields, "outputs", output_from_json);
    status.inputs = read_list<InputStatus>(fields, "inputs", input_from_json);
    status.left = read_list<InputStatus>(fields, "left", input_from_json);
    status.matching = read_list<MatchingStatus>(fields, "matching", matching_from_json);
    if (fields.has("last_exception"))
        status.last_exception = exception_from_json(fields.object("last_exception"));
    if (fields.has("halted")) {
        const Fields halted(fields.object("halted"), "halted");
        status.halted = {halted.text_or("by", ""), halted.integer_or("time_us", 0, max_json_integer, 0)};
    }
    status.places = read_list<std::string>(
        fields, "places", [](const Json& place) { return place.is_string() ? place.get<std::string>() : ""; });
    status.swarm = fields.text_or("swarm", "");
    if (fields.has("order"))
        status.order = drone_order_from_json(fields.object("order"));
    status.version = fields.text_or("version", "");
    return status;
}

}  // namespace hive
