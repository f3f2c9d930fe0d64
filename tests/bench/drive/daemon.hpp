// iox-roudi for the iceoryx row: started when both are there, ended by its id, its shared memory removed.
#pragma once

#include "process.hpp"

#include <filesystem>
#include <optional>
#include <set>

namespace hive::bench {

class Daemon {
public:
    /// @param programs  where the rows' programs are
    explicit Daemon(const std::filesystem::path& programs);
    ~Daemon();
    Daemon(const Daemon&) = delete;
    Daemon& operator=(const Daemon&) = delete;

    /// Is it there? Without it the iceoryx row is left out.
    [[nodiscard]] bool runs() const noexcept { return process_.has_value(); }

private:
    std::filesystem::path log_;
    std::set<std::filesystem::path> before_;  ///< the shared memory of others
    std::optional<test::Process> process_;
};

}  // namespace hive::bench
