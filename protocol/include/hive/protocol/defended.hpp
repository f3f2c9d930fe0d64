// For tests only: switches off a defence against a fault, to show that the promise then breaks.
#pragma once

#include <string_view>

namespace hive {

/// False when the environment variable HIVE_TEST_WITHOUT, a list with commas, contains this keyword. The variable is
/// read once, since a program may change its environment while other threads call this.
bool defended(std::string_view defence);

/// For a test that switches off a defence in its own process: such a list, instead of that variable. Not thread-safe.
void leave_out(std::string_view defences);

}  // namespace hive
