// Skips a test case that needs something this machine lacks. CTest shows it as skipped, never as passed.
#pragma once

#include <string>

namespace hive::test {

/// Call it first in a test case, and return if the result is false: `if (!possible(missing_for_lab())) return;`. A
/// program of several cases that is one test in CTest ends the name of such a case with "(needs ...)", which makes it a
/// test of its own (hive_program_test in CMakeLists.txt).
/// @param missing  what the case needs and this machine lacks; empty: nothing
bool possible(const std::string& missing);

/// For cases that measure, or that a sanitizer's own memory would disturb.
inline std::string missing_if_sanitized()
{
#ifdef HIVE_SANITIZED
    return "a build without sanitizers";
#else
    return "";
#endif
}

/// For main() of every test program: runs the selected cases.
/// @return  doctest's exit code, which is not 0 after any failure; 77 if nothing failed and every case was skipped
int run_cases(int argc, char** argv);

}  // namespace hive::test
