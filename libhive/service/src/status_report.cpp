// Combines the board, the outlets and the intakes.
#include "status_report.hpp"

#include <hive/event/ticket.hpp>
#include <hive/platform/usage.hpp>

namespace hive::service {

using event::Clock;

namespace {

MatchingStatus matching_row(const MatchedInputs& matching, const MatchCounts& counts)
{
    MatchingStatus row{.inputs = {},
                       .sets = counts.sets,
                       .waiting = counts.waiting,
                       .unmatched = counts.unmatched,
                       .duplicates = counts.duplicates,
                       .missing = counts.missing};
    for (const auto& input : matching.inputs) {
        row.inputs.push_back(input.name);
        row.missing.try_emplace(input.name, 0);
    }
    return row;
}

}  // namespace

/// Each receiver on another machine asks for the time every 2 s, and skips all rows, so the rows are not made.
Status StatusReport::page(std::int64_t skip, Role role) const
{
    auto status = skip == max_json_integer ? without_rows() : page_of(now(), skip);
    for (const auto& field : order_fields())
        if (field.for_operator && role == Role::viewer)
            field.copy(*status.order, {});
    return status;
}

Status StatusReport::now() const
{
    Status status = without_rows();
    const auto process = platform::process_usage();
    const auto machine = platform::machine_usage();
    status.encoding_us = event::microseconds(module_.encoding());
    status.cpu_us = process.cpu_us;
    status.memory = process.memory;
    status.machine = {machine.processors, machine.cpu_us, machine.memory, machine.memory_available,
                      machine.memory_limited};
    status.inputs = inputs();
    status.left = module_.left();
    auto output = status.outputs.begin();
    for (const auto& outlet : module_.outlets())
        (output++)->edges = outlet.edges();
    return status;
}

Status StatusReport::without_rows() const
{
    const auto board = board_.values();
    const auto busy_for = board.state == State::busy ? event::microseconds(Clock::now() - board.busy_since) : 0;
    Status status{.name = module_.self().name,
                  .kind = module_.self().kind,
                  .pid = module_.self().pid,
                  .epoch = module_.self().epoch,
                  .state = board_.stopping() ? State::stopping : board.state,
                  .policy = board.policy,
                  .condition = board.condition,
                  .uptime_us = event::microseconds(Clock::now() - started_),
                  .busy_us = board.busy_us + busy_for,
                  .busy_for_us = busy_for,
                  .callback = board.callback,
                  .why = why(board),
                  .source_events = board.source_events,
                  .outputs = {},
                  .inputs = {},
                  .left = {},
                  .matching = matching(board),
                  .last_exception = board.last_exception,
                  .halted = board.halted,
                  .places = listening_.places(),
                  .swarm = board.swarm,
                  .order = order(board),
                  .version = declaration_.interface.version};
    for (const auto& outlet : module_.outlets())
        status.outputs.push_back(outlet.status());
    return status;
}

/// The current configuration, which may differ from that of the start.
DroneOrder StatusReport::order(const StatusBoard::Values& board) const
{
    auto order = order_;
    order.on_exception = token(board.policy);
    order.halted = board_.halted();
    listening_.tell(order);
    return order;
}

Reason StatusReport::why(const StatusBoard::Values& board) const
{
    if (board.prepared)
        return Reason::set_prepared;
    if (module_.paused() != Reason::none)
        return module_.paused();
    if (!declaration_.interface.inputs.empty() && module_.intakes().empty())
        return Reason::no_input;
    return board.why;
}

/// A set is timed as its first input.
const std::string& StatusReport::callback_of(const std::string& input) const
{
    for (const auto& matching : declaration_.matchings)
        if (matching.input(input))
            return matching.inputs.front().name;
    return input;
}

std::vector<InputStatus> StatusReport::inputs() const
{
    std::vector<InputStatus> rows;
    for (const auto& intake : module_.intakes()) {
        rows.push_back(intake->status());
        rows.back().queued = mailbox_.count(event::came_over(*intake));
        rows.back().in_hand -= rows.back().queued;
        rows.back().work_p99_us = board_.work_p99_us(callback_of(rows.back().input));
    }
    return rows;
}

std::vector<MatchingStatus> StatusReport::matching(const StatusBoard::Values& board) const
{
    std::vector<MatchingStatus> rows;
    for (std::size_t i = 0; i < declaration_.matchings.size(); ++i)
        rows.push_back(
            matching_row(declaration_.matchings[i], i < board.matched.size() ? board.matched[i] : MatchCounts{}));
    return rows;
}

}  // namespace hive::service
