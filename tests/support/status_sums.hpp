// Sums over the status of a drone, and rows of it found by name.
#pragma once

#include <hive/status.hpp>

#include <stdexcept>
#include <string>

namespace hive::test {

/// A counter of all inputs, including ended connections.
inline std::int64_t at_inputs(const Status& status, std::int64_t InputStatus::*counter)
{
    std::int64_t sum = 0;
    for (const auto* rows : {&status.inputs, &status.left})
        for (const auto& input : *rows)
            sum += input.*counter;
    return sum;
}

/// The row of a receiver at a drone's first output.
inline const EdgeStatus& edge_to(const Status& status, const std::string& receiver)
{
    for (const auto& edge : status.outputs.at(0).edges)
        if (edge.receiver == receiver)
            return edge;
    throw std::runtime_error(status.name + " knows no receiver " + receiver);
}

/// The receivers of an output that are registered now.
inline std::size_t connected_edges(const OutputStatus& output)
{
    std::size_t count = 0;
    for (const auto& edge : output.edges)
        count += edge.connected && !edge.group ? 1 : 0;
    return count;
}

}  // namespace hive::test
