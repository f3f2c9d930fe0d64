// The report: Hive, its peers and the machine's limits side by side, then the targets.
#pragma once

#include "records.hpp"

namespace hive::bench {

void print_report(const Records& records);
/// One line for each target: what is wanted, what was measured, met or missed.
void print_targets(const Records& records);

}  // namespace hive::bench
