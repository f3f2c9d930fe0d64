// What made drones of this home fail: their inputs, in files for its user alone, the last 4 failures of a drone and 64
// MiB in all.
#pragma once

#include <hive/event/home.hpp>
#include <hive/kept_failure.hpp>

#include <string>
#include <vector>

namespace hive::event {

/// Any thread and process; files may be removed by hand at any time.
class FailureStore {
public:
    static constexpr std::size_t max_failures = 4;  ///< of a drone
    static constexpr std::size_t max_files = 256;
    static constexpr std::uintmax_t max_bytes = 64u << 20;
    /// Below the home.
    static constexpr const char* folder = ".failures";

    explicit FailureStore(const Home& home);

    /// A death that another sender has kept already has the same number; older failures make room.
    /// @param edge  the output and the input of what a sender keeps; empty: of the drone itself
    /// @return its number; 0: it is larger than the store
    /// @throws Error  io
    std::int64_t keep(const KeptFailure& failure, const std::string& edge = {}) const;
    /// The failures of a drone, by number. What cannot be read is left out.
    /// @param bodies  false: the events have their headers and sizes alone
    [[nodiscard]] std::vector<KeptFailure> read(const std::string& drone, bool bodies) const;
    /// Names of drones that it has failures of. Sorted.
    [[nodiscard]] std::vector<std::string> drones() const;

private:
    struct File;
    [[nodiscard]] std::vector<File> files() const;
    void make_room() const;

    std::filesystem::path directory_;
};

}  // namespace hive::event
