// The providers of places, and the resolution of references.
#include "directory.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hive {
namespace {

/// The drones of this machine: a socket in the home has the drone's name.
class HomePlaces final : public PlaceProvider {
public:
    explicit HomePlaces(const event::Home& home) : home_(home) {}

    [[nodiscard]] std::vector<Place> places() const override
    {
        std::vector<Place> found;
        for (const auto& name : home_.names())
            std::ranges::move(places_of(name), std::back_inserter(found));
        return found;
    }
    [[nodiscard]] std::vector<Place> places_of(const std::string& drone) const override
    {
        if (!is_name(drone) || !runs(drone))
            return {};
        return {{.drone = drone, .host = Place::here, .address = to_text(home_.address(drone))}};
    }

private:
    /// A program often queries one drone again and again.
    [[nodiscard]] bool runs(const std::string& drone) const
    {
        if (drone == last_ && event::Home::is_locked(lock_of_last_))
            return true;
        lock_of_last_ = home_.lock_of(drone);
        last_ = drone;
        return lock_of_last_ || home_.runs(drone);
    }

    const event::Home& home_;
    mutable std::string last_{};
    mutable transport::Descriptor lock_of_last_{};
};

/// The drones of other machines in the list of places.
class ListedPlaces final : public PlaceProvider {
public:
    explicit ListedPlaces(const PlaceList& list) : list_(list) {}

    [[nodiscard]] std::vector<Place> places() const override { return list_.places(); }
    [[nodiscard]] std::vector<Place> places_of(const std::string& drone) const override
    {
        const auto& all = list_.places();
        return {std::ranges::lower_bound(all, drone, {}, &Place::drone),
                std::ranges::upper_bound(all, drone, {}, &Place::drone)};
    }

private:
    const PlaceList& list_;
};

/// The drones announced on the local network, except those in the home or the list.
class AnnouncedPlaces final : public PlaceProvider {
public:
    AnnouncedPlaces(const event::Home& home, const PlaceList& list, const std::filesystem::path& key)
        : home_(home), list_(list), browser_(key, home.directory() / ".announced")
    {
    }

    [[nodiscard]] std::vector<Place> places() const override
    {
        std::vector<Place> found;
        for (const auto& drone : browser_.found())
            if (!(drone.same_machine && lives_here(drone)) && !is_listed(drone))
                found.push_back(
                    {.drone = drone.said.drone, .host = drone.host, .address = drone.address, .announced = true});
        return found;
    }
    [[nodiscard]] std::vector<Place> places_of(const std::string& drone) const override
    {
        auto found = places();
        std::erase_if(found, [&](const Place& place) { return place.drone != drone; });
        return found;
    }

private:
    /// Another home of this machine may have a drone of the same name, but not at the same port.
    [[nodiscard]] bool lives_here(const discovery::Neighbour& drone) const
    try {
        if (!home_.alive(drone.said.drone))
            return false;
        const auto state = home_.read_state(drone.said.drone).value_or(Json::object());
        const auto port = ":" + std::to_string(drone.port);
        for (const auto* key : {"listen", "advertise"})
            for (const auto& address : state.value(key, Json::array()))
                if (address.is_string() && address.get_ref<const std::string&>().ends_with(port))
                    return true;
        return false;
    } catch (const std::exception&) {
        return true;  // its state cannot be read, so the name decides
    }
    [[nodiscard]] bool is_listed(const discovery::Neighbour& drone) const
    {
        const auto port = ":" + std::to_string(drone.port);
        return std::ranges::any_of(list_.places(), [&](const Place& place) {
            return place.drone == drone.said.drone && place.address.ends_with(port)
                   && (place.address == drone.address || label(host_in(place)) == label(drone.host)
                       || place.host == drone.host);
        });
    }
    /// "cam1" of tcp://cam1:7700.
    static std::string host_in(const Place& place) { return transport::parse_address(place.address).host; }
    /// "cam1" of "cam1.example.org"; numbers stay as they are.
    static std::string label(const std::string& host)
    {
        const bool number = host.find_first_not_of("0123456789.") == std::string::npos;
        return number ? host : host.substr(0, host.find('.'));
    }

    const event::Home& home_;
    const PlaceList& list_;
    mutable discovery::Browser browser_;
};

/// "cam1:7700" of tcp://cam1:7700: distinguishes two drones of one host.
std::string host_and_port(const Place& place)
{
    constexpr std::string_view scheme = "tcp://";
    return place.address.starts_with(scheme) ? place.host + place.address.substr(place.address.rfind(':')) : place.host;
}

bool is_at(const Place& place, const std::string& host)
{
    return host.empty() || place.host == host || host_and_port(place) == host;
}

/// The shortest unambiguous reference among the places of its name.
std::string reference_to(const Place& place, const std::vector<Place>& same_name)
{
    if (same_name.size() == 1)
        return place.drone;
    const auto at_host = std::ranges::count(same_name, place.host, &Place::host);
    return place.drone + "@" + (at_host == 1 ? place.host : host_and_port(place));
}

std::string references_to(const std::vector<Place>& places)
{
    std::string text;
    for (const auto& place : places)
        text += (text.empty() ? "" : ", or ") + reference_to(place, places);
    return text;
}

}  // namespace

std::string drone_of(const std::string& reference) { return reference.substr(0, reference.find('@')); }

std::string machine_name(const std::string& ssh) { return ssh.substr(ssh.rfind('@') + 1); }

Directory::Directory(std::filesystem::path home, const std::filesystem::path& key)
    : home_(std::move(home)), list_(home_.directory()), network_(std::make_unique<AnnouncedPlaces>(home_, list_, key))
{
    known_.push_back(std::make_unique<HomePlaces>(home_));
    known_.push_back(std::make_unique<ListedPlaces>(list_));
}

std::vector<Place> Directory::places() const
{
    auto all = network_->places();
    for (const auto& provider : known_)
        std::ranges::move(provider->places(), std::back_inserter(all));
    std::ranges::stable_sort(all, {}, &Place::drone);
    return all;
}

std::vector<std::string> Directory::names() const
{
    const auto all = places();
    std::vector<std::string> names;
    for (auto from = all.begin(); from != all.end();) {
        const auto to = std::find_if(from, all.end(), [&](const Place& place) { return place.drone != from->drone; });
        const std::vector<Place> same_name(from, to);
        for (const auto& place : same_name)
            names.push_back(reference_to(place, same_name));
        from = to;
    }
    return names;
}

namespace {

std::vector<Place> of_all(const std::vector<std::unique_ptr<PlaceProvider>>& providers, const std::string& drone)
{
    std::vector<Place> found;
    for (const auto& provider : providers)
        std::ranges::move(provider->places_of(drone), std::back_inserter(found));
    return found;
}

/// "cam1" of "camera@cam1"; nothing when no host is named.
std::optional<std::string> host_named(const std::string& reference)
{
    const auto at = reference.find('@');
    return at == std::string::npos ? std::nullopt : std::optional(reference.substr(at + 1));
}

/// The one of these that a reference matches.
std::optional<Place> meant(std::vector<Place> found, const std::string& reference)
{
    if (const auto host = host_named(reference))
        std::erase_if(found, [&](const Place& place) { return host->empty() || !is_at(place, *host); });
    if (found.empty())
        return std::nullopt;
    if (found.size() > 1)
        throw Error(Errc::invalid_argument, "several drones are called " + drone_of(reference),
                    "say which: " + references_to(found));
    return found.front();
}

}  // namespace

std::vector<Place> Directory::all_of(const std::string& drone) const
{
    auto found = of_all(known_, drone);
    return found.empty() && is_name(drone) ? network_->places_of(drone) : found;
}

std::optional<Place> Directory::find_known(const std::string& reference) const
{
    return meant(of_all(known_, drone_of(reference)), reference);
}

std::optional<Place> Directory::find(const std::string& reference) const
{
    if (auto known = find_known(reference); known || host_named(reference) == Place::here)
        return known;
    if (!is_name(drone_of(reference)))
        return std::nullopt;
    return meant(network_->places_of(drone_of(reference)), reference);
}

}  // namespace hive
