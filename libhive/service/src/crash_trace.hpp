// Reports where a process crashes: a stack trace on stderr, and the cause in a file for other processes.
#pragma once

#include <filesystem>

namespace hive::service {

/// Call it once, on the user thread. From then on SIGSEGV, SIGBUS, SIGILL, SIGFPE and SIGABRT write a trace before the
/// process dies, and `note`, a JSON object: {"pid", "signal", "time_us", "function", "source"}, the last two if known.
/// A signal with an existing handler keeps it; under a sanitizer all do.
void trace_crashes(const std::filesystem::path& note);

}  // namespace hive::service
