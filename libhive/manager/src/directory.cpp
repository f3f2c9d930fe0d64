// The providers of places, and what a reference means.
#include "directory.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hive {
namespace {

/// The drones of this machine: a socket in the home is a name.
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
        if (!is_name(drone) || !home_.alive(drone))
            return {};
        return {{.drone = drone, .host = Place::here, .address = to_text(home_.address(drone))}};
    }

private:
    const event::Home& home_;
};

/// Those of other machines that this home was told of.
class ListedPlaces final : public PlaceProvider {
public:
    explicit ListedPlaces(const PlaceList& list) : list_(list) {}

    [[nodiscard]] std::vector<Place> places() const override { return list_.places(); }
    [[nodiscard]] std::vector<Place> places_of(const std::string& drone) const override
    {
        std::vector<Place> found;
        std::ranges::copy_if(list_.places(), std::back_inserter(found),
                             [&](const Place& place) { return place.drone == drone; });
        return found;
    }

private:
    const PlaceList& list_;
};

/// "cam1:7700" of tcp://cam1:7700: tells apart what one host has twice.
std::string host_and_port(const Place& place)
{
    constexpr std::string_view scheme = "tcp://";
    return place.address.starts_with(scheme) ? place.host + place.address.substr(place.address.rfind(':')) : place.host;
}

bool is_at(const Place& place, const std::string& host)
{
    return host.empty() || place.host == host || host_and_port(place) == host;
}

/// The shortest that means this place alone among those of its name.
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

Directory::Directory(std::filesystem::path home) : home_(std::move(home)), list_(home_.directory())
{
    providers_.push_back(std::make_unique<HomePlaces>(home_));
    providers_.push_back(std::make_unique<ListedPlaces>(list_));
}

std::vector<Place> Directory::places() const
{
    std::vector<Place> all;
    for (const auto& provider : providers_)
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

std::vector<Place> Directory::all_of(const std::string& drone) const
{
    std::vector<Place> found;
    for (const auto& provider : providers_)
        std::ranges::move(provider->places_of(drone), std::back_inserter(found));
    return found;
}

std::optional<Place> Directory::find(const std::string& reference) const
{
    const auto drone = drone_of(reference);
    const bool with_host = drone.size() < reference.size();
    const auto host = with_host ? reference.substr(drone.size() + 1) : "";
    auto found = all_of(drone);
    if (with_host)
        std::erase_if(found, [&](const Place& place) { return host.empty() || !is_at(place, host); });
    if (found.empty())
        return std::nullopt;
    if (found.size() > 1)
        throw Error(Errc::invalid_argument, "several drones are called " + drone, "say which: " + references_to(found));
    return found.front();
}

}  // namespace hive
