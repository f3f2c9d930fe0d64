// For tests only: what Hive does against a fault can be left out, to show that the promise then breaks.
#pragma once

#include <string_view>

namespace hive {

/// False when the environment variable HIVE_TEST_WITHOUT, a list with commas, has this word. The variable is read once,
/// since a program may change its environment while other threads ask.
bool defended(std::string_view defence);

/// For a test that leaves something out in its own process: such a list, instead of that variable. Called while no
/// thread asks.
void leave_out(std::string_view defences);

}  // namespace hive
