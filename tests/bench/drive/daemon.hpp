// iox-roudi for the iceoryx row: started when both are there, ended by its id, its shared memory removed. There can be
// only one on a machine: where another runs already, ours does not start and the row is left out.
#pragma once

#include "process.hpp"

#include <filesystem>
#include <optional>

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
    std::optional<test::Process> process_;
};

}  // namespace hive::bench
