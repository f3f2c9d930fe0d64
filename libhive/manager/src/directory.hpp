// Finds the drones of a swarm: queries the providers of places, one after the other.
#pragma once

#include "place_list.hpp"

#include <hive/discovery/browser.hpp>
#include <hive/event/home.hpp>

#include <functional>
#include <memory>
#include <optional>

namespace hive {

/// A source of places of drones. To add one: its file and one line in the constructor of Directory.
class PlaceProvider {
public:
    virtual ~PlaceProvider() = default;
    /// All places that it knows.
    [[nodiscard]] virtual std::vector<Place> places() const = 0;
    /// Those of one drone, usually one.
    [[nodiscard]] virtual std::vector<Place> places_of(const std::string& drone) const = 0;
};

/// For one thread. The network is queried only for drones that neither the home nor the list has, and for all places. A
/// drone is identified by NAME, or NAME@HOST; by NAME@HOST:PORT if that is ambiguous.
class Directory {
public:
    /// @param key  the swarm's key file: only drones of the local network with this key are listed; empty: none
    explicit Directory(std::filesystem::path home, const std::filesystem::path& key = {});
    Directory(const Directory&) = delete;  // the providers know its parts
    Directory& operator=(const Directory&) = delete;

    [[nodiscard]] const event::Home& home() const noexcept { return home_; }
    [[nodiscard]] PlaceList& list() noexcept { return list_; }

    [[nodiscard]] std::vector<Place> places() const;
    /// The references to all drones: NAME, and NAME@HOST if several have the name. Sorted.
    [[nodiscard]] std::vector<std::string> names() const;
    /// Nothing if there is none. Throws Errc::invalid_argument if the reference is ambiguous.
    [[nodiscard]] std::optional<Place> find(const std::string& reference) const;
    /// The same, but only from the home and the list, without waiting for a network.
    [[nodiscard]] std::optional<Place> find_known(const std::string& reference) const;
    /// All drones of one name; from the network only if the others have none.
    [[nodiscard]] std::vector<Place> all_of(const std::string& drone) const;

private:
    event::Home home_;
    PlaceList list_;
    std::vector<std::unique_ptr<PlaceProvider>> known_;  ///< the nearest first
    std::unique_ptr<PlaceProvider> network_;             ///< queried for the others
};

/// "camera" of "camera" and of "camera@cam1".
std::string drone_of(const std::string& reference);
/// "cam1" of "cam1" and of "user@cam1", the machine of ssh.
std::string machine_name(const std::string& ssh);
/// Is it on this machine, in the home?
inline bool is_here(const Place& place) { return place.host == Place::here; }

}  // namespace hive
