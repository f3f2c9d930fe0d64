// Where the drones of a swarm are: asks what knows of places, one after the other.
#pragma once

#include "place_list.hpp"

#include <hive/discovery/browser.hpp>
#include <hive/event/home.hpp>

#include <functional>
#include <memory>
#include <optional>

namespace hive {

/// Something that knows where drones are. A further kind is its file and one line in the constructor of Directory.
class PlaceProvider {
public:
    virtual ~PlaceProvider() = default;
    /// All places that it knows.
    [[nodiscard]] virtual std::vector<Place> places() const = 0;
    /// Those of one drone. Mostly one.
    [[nodiscard]] virtual std::vector<Place> places_of(const std::string& drone) const = 0;
};

/// For one thread. What the home and the list know is used at once; the network is asked for what they do not, and for
/// all places. A drone is meant by its name, or by NAME@HOST; by NAME@HOST:PORT if that is not enough.
class Directory {
public:
    /// @param key  the swarm's key file: drones of the local network count that have it; empty: none do
    explicit Directory(std::filesystem::path home, const std::filesystem::path& key = {});
    Directory(const Directory&) = delete;  // the providers know its parts
    Directory& operator=(const Directory&) = delete;

    [[nodiscard]] const event::Home& home() const noexcept { return home_; }
    [[nodiscard]] PlaceList& list() noexcept { return list_; }

    [[nodiscard]] std::vector<Place> places() const;
    /// What the drones are called here: names, and NAME@HOST of those whose name is not theirs alone. Sorted.
    [[nodiscard]] std::vector<std::string> names() const;
    /// Nothing when there is none. Throws Errc::invalid_argument when several are meant.
    [[nodiscard]] std::optional<Place> find(const std::string& reference) const;
    /// The same in the home and the list alone, without waiting for a network.
    [[nodiscard]] std::optional<Place> find_known(const std::string& reference) const;
    /// All drones of one name; of the network only if the others know none.
    [[nodiscard]] std::vector<Place> all_of(const std::string& drone) const;

private:
    event::Home home_;
    PlaceList list_;
    std::vector<std::unique_ptr<PlaceProvider>> known_;  ///< the nearest first
    std::unique_ptr<PlaceProvider> network_;             ///< what these do not know
};

/// "camera" of "camera" and of "camera@cam1".
std::string drone_of(const std::string& reference);
/// On this machine, in the home?
inline bool is_here(const Place& place) { return place.host == Place::here; }

}  // namespace hive
