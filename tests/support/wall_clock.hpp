// A wall clock for drones that can be set while they run, by Debian's libfaketime; their steady clock is unaffected.
#pragma once

#include "eventually.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace hive::test {

/// Begins right.
class WallClock {
public:
    /// What is missing for it on this machine; empty if nothing.
    static std::string missing()
    {
        return std::filesystem::exists(library) && !sanitized() ? "" : "libfaketime, and a build without sanitizers";
    }

    explicit WallClock(const std::filesystem::path& folder) : file_(folder / "wall-clock") { set("+0"); }
    /// @param offset  in seconds, with a sign
    void set(const std::string& offset) const
    {
        const auto fresh = file_.string() + ".new";
        std::ofstream(fresh) << offset << "\n";
        std::filesystem::rename(fresh, file_);
    }
    /// The environment for drones with this clock.
    [[nodiscard]] std::vector<std::string> environment() const
    {
        return {std::string("LD_PRELOAD=") + library, "FAKETIME_TIMESTAMP_FILE=" + file_.string(),
                "FAKETIME_NO_CACHE=1", "FAKETIME_DONT_FAKE_MONOTONIC=1"};
    }

private:
    static constexpr const char* library = "/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1";
    std::filesystem::path file_;
};

}  // namespace hive::test
