// A new process in the place of a drone that runs.
#pragma once

#include <hive/application.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace hive {

struct ReplaceOptions {
    std::string kind{};                             ///< what the new one is, or a FILE.py; empty: what the old one is
    Json parameters = Json::object();               ///< set for the new one, beside what the old one was told
    std::vector<std::string> arguments{};           ///< further words of its command line
    std::chrono::milliseconds ready_within{10000};  ///< before the old one is asked to hand over
    bool lose_state = false;                        ///< the old one may forget what it remembers of earlier events
    std::filesystem::path home{};                   ///< empty: default_home()
    std::function<bool()> cancelled{};  ///< asked while it waits; true: Errc::stopped, and what is begun goes on
    /// Hears the last lines of the log when the new one has failed.
    std::function<void(const std::string& line)> last_words = [](const std::string&) {};
};

/// What came of it.
struct Replaced {
    std::string drone, kind;
    std::int64_t pid = 0, before = 0;  ///< of the new process and of the old one
    std::filesystem::path log{};
};

/// Starts a process that takes over from a drone of this machine: it gets ready while the old one works, then name,
/// place, parameters and connections pass over, and the old one ends with the callback that it is in. A drone that has
/// halted stays halted. Returns when the new one answers. What is begun goes on when the caller is killed.
///
/// Until the new one is ready, everything that goes wrong throws and leaves the old one as it was: Errc::not_found (no
/// such drone, no such program), Errc::type_mismatch and Errc::refused (the new one does not have what is connected or
/// set; the old one remembers, and `lose_state` is not given), Errc::name_taken (it is being replaced already),
/// Errc::timeout. If the new one dies between that and its first answer, another one is started in its place.
Replaced replace(Application& application, const std::string& drone, const ReplaceOptions& options = {});

}  // namespace hive
