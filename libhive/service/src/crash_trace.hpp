// A process that dies of a crash says where: a stack trace on stderr, and its cause in a file that others read.
#pragma once

#include <filesystem>

namespace hive::service {

/// Once, by the user thread. From now on SIGSEGV, SIGBUS, SIGILL, SIGFPE and SIGABRT write a trace before the process
/// dies of them, and `note`, a JSON object: {"pid", "signal", "time_us", "function", "source"}, the last two as far as
/// they are known. A signal that has a handler already keeps it; under a sanitizer all do.
void trace_crashes(const std::filesystem::path& note);

}  // namespace hive::service
