// The inputs that made drones of this runtime directory fail, in files that only its user can read: the last 4 failures
// of a drone and 64 MiB in all.
#pragma once

#include <hive/event/failure_file.hpp>
#include <hive/event/home.hpp>

#include <chrono>
#include <string>
#include <vector>

namespace hive::event {

/// Any thread and process; files may be removed by hand at any time.
class FailureStore {
public:
    static constexpr std::size_t max_failures = 4;  ///< of a drone
    static constexpr std::size_t max_files = 256;
    static constexpr std::uintmax_t max_bytes = max_failure_bytes;
    /// How long keep() waits for another process that has locked the folder.
    static constexpr std::chrono::milliseconds max_wait{500};
    /// Below the runtime directory.
    static constexpr const char* folder = ".failures";

    explicit FailureStore(const Home& home);

    /// A crash that another sender has kept already keeps its number; older failures are evicted first.
    /// @param edge  the output and the input of an event that a sender keeps; empty: kept by the drone itself
    /// @return its number; 0: it is larger than the store
    /// @throws Error  io; timeout: another process keeps the folder locked; refused: failures that others write at this
    ///                time fill it
    std::int64_t keep(const KeptFailure& failure, const std::string& edge = {}) const;
    /// The failures of a drone, by number. Unreadable ones are skipped.
    /// @param bodies  false: the events have only their headers and sizes
    [[nodiscard]] std::vector<KeptFailure> read(const std::string& drone, bool bodies) const;
    /// Names of the drones with failures, sorted.
    [[nodiscard]] std::vector<std::string> drones() const;

private:
    struct File;
    [[nodiscard]] std::vector<File> files() const;
    [[nodiscard]] std::uintmax_t unfinished_bytes() const;
    [[nodiscard]] static std::int64_t number_for(const KeptFailure& failure, const std::vector<File>& files);
    void make_room(const KeptFailure& failure, std::uintmax_t bytes) const;

    std::filesystem::path directory_;
};

}  // namespace hive::event
