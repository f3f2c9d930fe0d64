// The list of places: a small file in the home that says where drones on other machines are.
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

    /// As the file has them now, sorted by drone. Throws Errc::malformed, Errc::io.
    [[nodiscard]] const std::vector<Place>& places() const;
    /// Adds a place; one of the same drone at the same host and port is replaced. Throws Errc::invalid_argument.
    void add(const Place& place);
    /// Adds places; whatever else the list says of the same drones at the same hosts is out of date and goes.
    void replace(const std::vector<Place>& places);
    /// False: it was not there.
    bool forget(const Place& place);
    /// These have answered now. What cannot be written is left out: nobody has asked for it.
    void answered(const std::vector<Place>& places) noexcept;

private:
    void change(const std::function<bool(std::vector<Place>&)>& change);
    void write(const std::vector<Place>& places) const;

    std::filesystem::path file_, lock_;
    mutable std::vector<Place> read_;  ///< what the file held when it was this one:
    mutable struct stat of_ {
    };
};

}  // namespace hive
