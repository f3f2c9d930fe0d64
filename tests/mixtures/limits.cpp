// Limits that follow from the topology of a round.
#include "limits.hpp"

namespace hive::mixtures {
namespace {

/// Where somebody is asked or waited for. A round feeds several times as many.
constexpr std::int64_t max_asked = 256;
/// Not acknowledged by one receiver (Credit::most_under_way, beyond its window), and by the two of a group.
constexpr std::int64_t max_unacknowledged = 256 + 64, members = 2;
/// Live events of a stream, at either end (Subscription::max_queued_events, Mailbox::most_events).
constexpr std::int64_t max_streamed_live = 1024;
/// Of those in hand, one is with the drone's code, and the end of another is being told. The others were discarded at
/// once, as a whole queue is, and the end of each is still to be told.
constexpr std::int64_t max_beyond_queue = 2;
/// Of an output: the collector, the hearer, a group.
constexpr std::int64_t other_edges = 3;
/// Of an input that is being connected anew.
constexpr std::int64_t other_inputs = 1;

class Report {
public:
    void at_most(std::int64_t limit, std::int64_t size, const auto&... what)
    {
        if (size > limit)
            problems.push_back("bounded: " + (std::string(what) + ...) + ": " + std::to_string(size) + ", and at most "
                               + std::to_string(limit) + " are possible");
    }
    Problems problems;
};

}  // namespace

/// What a live stream has queued stays when its connection is changed to another kind.
Sizes::Sizes(const Topology& topology, std::int64_t guests, std::int64_t places)
    : max_queued_(topology.demand ? max_asked : max_streamed_live), max_places_(places)
{
    for (const auto& drone : topology.drones())
        most_[drone] = {other_edges + guests, other_inputs};
    for (const auto& edge : topology.edges()) {
        ++most_[edge.sender].edges;
        ++most_[edge.receiver].inputs;
    }
}

Problems Sizes::look(const Statuses& statuses) const
{
    Report report;
    for (const auto& [name, status] : statuses) {
        const auto& most = most_.at(name);
        for (const auto& output : status.outputs) {
            report.at_most(most.edges, std::ssize(output.edges), "edges of ", name, ".", output.name);
            for (const auto& edge : output.edges) {
                report.at_most(max_queued_, edge.waiting, "waiting of ", name, " -> ", edge.receiver);
                report.at_most(max_queued_ + (edge.group ? members : 1) * max_unacknowledged, edge.events.in_flight(),
                               "in flight of ", name, " -> ", edge.receiver);
            }
        }
        for (const auto& input : status.inputs) {
            report.at_most(max_queued_, input.queued, "queued of ", input.from, " -> ", name);
            report.at_most(max_queued_ + max_beyond_queue, input.in_hand, "in hand of ", input.from, " -> ", name);
        }
        report.at_most(most.inputs, std::ssize(status.inputs), "inputs of ", name);
        report.at_most(1, std::ssize(status.left), "left inputs of ", name);
        report.at_most(max_places_, std::ssize(status.places), "places of ", name);
    }
    return report.problems;
}

}  // namespace hive::mixtures
