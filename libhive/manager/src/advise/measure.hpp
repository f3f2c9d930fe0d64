// Measures lines: reads the counters twice, and the headers of the events in between.
#pragma once

#include "line.hpp"
#include "trace.hpp"

namespace hive::advising {

/// A line, and the drones of its steps.
struct Measured {
    std::vector<Step> way;
    Line line;
};

std::vector<Measured> measure(Application& application, const std::vector<std::string>& drones,
                              std::chrono::milliseconds time);

}  // namespace hive::advising
