// Puts together what the board, the outlets and the intakes say.
#include "status_report.hpp"

namespace hive::service {

using event::Clock;

namespace {

constexpr std::size_t most_receivers_listed = 128;  ///< so that a status with all its rows fits into one header

Json counts_json(const StatusBoard::Values& board)
{
    return {{"received", board.received},     {"processed", board.processed}, {"abandoned", board.abandoned},
            {"duplicates", board.duplicates}, {"discarded", board.discarded}, {"dropped", board.dropped}};
}

Json matching_row(const MatchedInputs& matching, const MatchCounts& counts)
{
    Json inputs = Json::array(), missing = Json::object();
    for (const auto& input : matching.inputs) {
        inputs.push_back(input.name);
        const auto found = counts.missing.find(input.name);
        missing[input.name] = found == counts.missing.end() ? 0 : found->second;
    }
    return {{"inputs", inputs},
            {"sets", counts.sets},
            {"waiting", counts.waiting},
            {"unmatched", counts.unmatched},
            {"duplicates", counts.duplicates},
            {"missing", missing}};
}

}  // namespace

Json StatusReport::now() const
{
    const auto board = board_.values();
    const auto busy_for = board.state == State::busy ? event::microseconds(Clock::now() - board.busy_since) : 0;
    Json json{{"name", module_.self().name},
              {"kind", module_.self().kind},
              {"pid", module_.self().pid},
              {"epoch", module_.self().epoch},
              {"state", token(board_.stopping() ? State::stopping : board.state)},
              {"condition", board.condition},
              {"policy", token(board.policy)},
              {"uptime_us", event::microseconds(Clock::now() - started_)},
              {"busy_us", board.busy_us + busy_for},
              {"busy_for_us", busy_for},
              {"callback", board.callback},
              {"queued", mailbox_.events()},
              {"events", counts_json(board)},
              {"outputs", outputs()},
              {"inputs", inputs(board)}};
    if (!declaration_.matchings.empty())
        json["matching"] = matching(board);
    if (!board.last_exception.is_null())
        json["last_exception"] = board.last_exception;
    return json;
}

Json StatusReport::outputs() const
{
    Json rows = Json::array();
    std::size_t receivers = most_receivers_listed;
    for (const auto& outlet : module_.outlets())
        rows.push_back(outlet.status(receivers));
    return rows;
}

Json StatusReport::inputs(const StatusBoard::Values& board) const
{
    Json rows = Json::array();
    for (const auto& intake : module_.intakes()) {
        Json row = intake->status();
        const auto abandoned = board.abandoned_at.find(intake->spec().input);
        row["abandoned"] = abandoned == board.abandoned_at.end() ? 0 : abandoned->second;
        rows.push_back(std::move(row));
    }
    return rows;
}

Json StatusReport::matching(const StatusBoard::Values& board) const
{
    Json rows = Json::array();
    for (std::size_t i = 0; i < declaration_.matchings.size(); ++i)
        rows.push_back(
            matching_row(declaration_.matchings[i], i < board.matched.size() ? board.matched[i] : MatchCounts{}));
    return rows;
}

}  // namespace hive::service
