// The list of places: a small file in the home with the addresses of drones on other machines.
#pragma once

#include <hive/application.hpp>

#include <sys/stat.h>

#include <filesystem>
#include <functional>

namespace hive {

/// For one thread; processes change the file one at a time, and each change replaces it, so that readers need no lock.
class PlaceList {
public:
    explicit PlaceList(const std::filesystem::path& home);

    /// The current content of the file, sorted by drone. Throws Errc::malformed, Errc::io.
    [[nodiscard]] const std::vector<Place>& places() const;
    /// Adds a place, and replaces one of the same drone at the same host and port. Throws Errc::invalid_argument.
    void add(const Place& place);
    /// Adds places, and removes older ones of the same drones at the same hosts.
    void replace(const std::vector<Place>& places);
    /// False: not found.
    bool forget(const Place& place);
    /// Saves that these have answered now. Ignores errors: no caller asked for it.
    void answered(const std::vector<Place>& places) noexcept;

private:
    void change(const std::function<bool(std::vector<Place>&)>& change);
    void write(const std::vector<Place>& places) const;

    std::filesystem::path file_;
    mutable std::vector<Place> read_;  ///< the content of the file in this version:
    mutable struct stat of_ {
    };
};

}  // namespace hive
