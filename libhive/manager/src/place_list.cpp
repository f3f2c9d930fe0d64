// Reads and replaces the file of places.
#include "place_list.hpp"

#include <hive/event/clock.hpp>
#include <hive/event/home.hpp>
#include <hive/json.hpp>
#include <hive/name.hpp>
#include <hive/transport/address.hpp>
#include <hive/transport/folder_lock.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <string_view>
#include <tuple>

namespace hive {
namespace {

namespace fs = std::filesystem;

constexpr JsonLimits file_limits{.bytes = 4 << 20, .depth = 4, .keys = 16, .string_bytes = 1024};
/// Minimum interval between saved answers of a drone, so that a query every second writes little.
constexpr std::int64_t answer_grain_us = 1'000'000;

Json place_to_json(const Place& place)
{
    Json json{{"drone", place.drone}, {"host", place.host}, {"address", place.address}};
    if (!place.ssh.empty())
        json["ssh"] = place.ssh;
    if (place.answered_us != 0)
        json["answered_us"] = place.answered_us;
    return json;
}

Place place_from_json(const Json& object)
{
    const Fields fields(object, "place");
    return {.drone = fields.name("drone"),
            .host = fields.text("host"),
            .address = to_text(transport::parse_address(fields.text("address"))),
            .ssh = fields.text_or("ssh", ""),
            .answered_us = fields.integer_or("answered_us", 0, max_json_integer, 0)};
}

auto place_order(const Place& place) { return std::tie(place.drone, place.host, place.address); }

bool same_place(const Place& one, const Place& other) { return place_order(one) == place_order(other); }

bool same_file(const struct stat& one, const struct stat& other)
{
    return one.st_ino == other.st_ino && one.st_size == other.st_size && one.st_mtim.tv_sec == other.st_mtim.tv_sec
           && one.st_mtim.tv_nsec == other.st_mtim.tv_nsec;
}

std::vector<Place> read_places(const fs::path& file)
try {
    std::ifstream in(file);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const Json list = parse_json(text, file_limits);
    std::vector<Place> places;
    for (const Fields fields(list, "the list of places"); const auto& item : fields.array("places"))
        places.push_back(place_from_json(item));
    std::ranges::sort(places, {}, place_order);
    return places;
} catch (const Error& error) {
    throw Error(Errc::malformed, file.string() + " cannot be read: " + error.what(),
                "fix it, or delete it: rm " + file.string());
}

void require_possible(const Place& place)
{
    require_name(place.drone, "drone");
    const auto address = transport::parse_address(place.address);
    if (address.scheme != transport::Address::Scheme::tcp || address.port == 0)
        throw Error(Errc::invalid_argument, place.address + " is not a TCP address",
                    "write tcp://HOST:PORT; local drones need no entry");
    if (place.host.empty() || place.host == Place::here)
        throw Error(Errc::invalid_argument, "a place on another machine is not called " + in_quotes(place.host));
}

}  // namespace

// No drone's name begins with a dot.
PlaceList::PlaceList(const fs::path& home) : file_(home / ".places") {}

const std::vector<Place>& PlaceList::places() const
{
    struct stat now {};
    if (::stat(file_.c_str(), &now) != 0) {
        if (errno != ENOENT)
            throw Error(Errc::io, "cannot stat " + file_.string() + ": " + std::strerror(errno));
        now = {};
        read_.clear();
    } else if (!same_file(now, of_)) {
        read_ = read_places(file_);
    }
    of_ = now;
    return read_;
}

void PlaceList::add(const Place& place)
{
    require_possible(place);
    change([&](std::vector<Place>& places) {
        std::erase_if(places, [&](const Place& other) { return same_place(other, place); });
        places.push_back(place);
        return true;
    });
}

void PlaceList::replace(const std::vector<Place>& places)
{
    std::map<std::pair<std::string_view, std::string_view>, const Place*> fresh;
    for (const auto& place : places) {
        require_possible(place);
        fresh[{place.drone, place.host}] = &place;
    }
    if (fresh.empty())
        return;
    change([&](std::vector<Place>& known) {
        std::erase_if(known, [&](const Place& other) { return fresh.contains({other.drone, other.host}); });
        for (const auto& [key, place] : fresh)
            known.push_back(*place);
        return true;
    });
}

bool PlaceList::forget(const Place& place)
{
    bool found = false;
    change([&](std::vector<Place>& places) {
        return found = std::erase_if(places, [&](const Place& other) { return same_place(other, place); }) > 0;
    });
    return found;
}

void PlaceList::answered(const std::vector<Place>& places) noexcept
try {
    const auto now = event::wall_us();
    const auto is_old = [&](const Place& place) { return now - place.answered_us >= answer_grain_us; };
    if (std::ranges::none_of(places, is_old))
        return;
    change([&](std::vector<Place>& known) {
        for (auto& place : known)
            if (std::ranges::any_of(places, [&](const Place& other) { return same_place(other, place); }))
                place.answered_us = now;
        return true;
    });
} catch (const std::exception&) {
}

void PlaceList::change(const std::function<bool(std::vector<Place>&)>& change)
{
    const transport::FolderLock lock(file_.parent_path());
    auto places = this->places();
    if (change(places))
        write(places);
}

void PlaceList::write(const std::vector<Place>& places) const
{
    Json list = Json::array();
    for (const auto& place : places)
        list.push_back(place_to_json(place));
    event::replace_file(file_, Json{{"places", list}}.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace hive
