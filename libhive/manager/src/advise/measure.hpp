// Measures lines: two looks at the counters, and the headers of the events between them.
#pragma once

#include "line.hpp"
#include "trace.hpp"

namespace hive::advising {

/// A line, and who does its steps.
struct Measured {
    std::vector<Step> way;
    Line line;
};

std::vector<Measured> measure(Application& application, const std::vector<std::string>& drones,
                              std::chrono::milliseconds time);

}  // namespace hive::advising
