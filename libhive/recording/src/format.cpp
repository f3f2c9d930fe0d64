// Writes prefixes as bytes and summaries as JSON, and derives ports from tracks.
#include <hive/recording/format.hpp>
#include <hive/json.hpp>
#include <hive/name.hpp>
#include <hive/printable.hpp>

#include <zlib.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace hive::recording {

using hive::Fields;
using hive::Json;

namespace {

template <class Projection>
std::int64_t sum(const std::vector<Track>& tracks, Projection what)
{
    return std::accumulate(tracks.begin(), tracks.end(), std::int64_t{0},
                           [&](std::int64_t total, const Track& track) { return total + track.*what; });
}

Json to_json(const Track& track)
{
    return {{"sender", track.sender},     {"output", track.output},  {"type", track.type},
            {"events", track.events},     {"bytes", track.bytes},    {"without_body", track.without_body},
            {"first_us", track.first_us}, {"last_us", track.last_us}};
}

std::int64_t count_from(const Fields& fields, const char* key)
{
    return fields.integer(key, 0, hive::max_json_integer);
}

std::int64_t time_from(const Fields& fields, const char* key) { return fields.integer(key, 0, most_time_us); }

Track track_from(const Json& json)
{
    const Fields fields(json, "track");
    return {fields.name("sender"),         fields.name("output"),       fields.text("type"),
            count_from(fields, "events"),  count_from(fields, "bytes"), count_from(fields, "without_body"),
            time_from(fields, "first_us"), time_from(fields, "last_us")};
}

Loss loss_from(const Json& json)
{
    const Fields fields(json, "loss");
    return {shortened(fields.text("from")), shortened(fields.text("reason")), count_from(fields, "events")};
}

bool has_type(const std::string& types, const std::string& type)
{
    return ("," + types + ",").find("," + type + ",") != std::string::npos;
}

/// The best free name.
std::string port_name(const Track& track, bool alone, const std::set<std::string>& taken, std::size_t number)
{
    for (const auto& name : {alone ? track.output : std::string(), track.sender + "-" + track.output})
        if (hive::is_name(name) && name != "exceptions" && !taken.contains(name))
            return name;
    return "output-" + std::to_string(number);
}

}  // namespace

void put_number(std::span<std::byte> to, std::uint64_t number)
{
    for (auto& byte : to) {
        byte = static_cast<std::byte>(number & 0xFF);
        number >>= 8;
    }
}

std::uint64_t number_in(std::span<const std::byte> bytes)
{
    std::uint64_t number = 0;
    for (std::size_t i = bytes.size(); i-- > 0;)
        number = number << 8 | static_cast<std::uint64_t>(bytes[i]);
    return number;
}

std::uint32_t crc(std::span<const std::byte> bytes, std::uint32_t before)
{
    return static_cast<std::uint32_t>(
        ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::array<std::byte, prefix_size> encode(const Prefix& prefix)
{
    std::array<std::byte, prefix_size> bytes{};
    const std::span all(bytes);
    put_number(all.subspan(0, 4), static_cast<std::uint32_t>(prefix.kind));
    put_number(all.subspan(4, 4), prefix.track);
    put_number(all.subspan(8, 4), prefix.text_size);
    put_number(all.subspan(12, 4), prefix.body_size);
    put_number(all.subspan(16, 8), static_cast<std::uint64_t>(prefix.time_us));
    put_number(all.subspan(24, 4), prefix.text_crc);
    put_number(all.subspan(28, 4), prefix.body_crc);
    put_number(all.subspan(32, 4), crc(all.first(32)));
    return bytes;
}

std::optional<Prefix> decode(std::span<const std::byte, prefix_size> bytes)
{
    const auto small = [&](std::size_t at) { return static_cast<std::uint32_t>(number_in(bytes.subspan(at, 4))); };
    const Prefix prefix{static_cast<Kind>(small(0)),
                        small(4),
                        small(8),
                        small(12),
                        static_cast<std::int64_t>(number_in(bytes.subspan(16, 8))),
                        small(24),
                        small(28)};
    const bool known = prefix.kind == Kind::begin || prefix.kind == Kind::event || prefix.kind == Kind::end;
    if (!known || small(32) != crc(bytes.first(32)) || prefix.time_us < 0 || prefix.time_us > most_time_us)
        return std::nullopt;
    return prefix;
}

std::int64_t Summary::events() const { return sum(tracks, &Track::events); }
std::int64_t Summary::bytes() const { return sum(tracks, &Track::bytes); }

std::string to_text(const Summary& summary)
{
    Json tracks = Json::array(), lost = Json::array();
    for (const auto& track : summary.tracks)
        tracks.push_back(to_json(track));
    for (const auto& loss : summary.lost)
        lost.push_back({{"from", loss.from}, {"reason", loss.reason}, {"events", loss.events}});
    return Json{{"begun_us", summary.begun_us},
                {"duration_us", summary.duration_us},
                {"ended", summary.ended},
                {"tracks", tracks},
                {"lost", lost}}
        .dump(-1, ' ', false, Json::error_handler_t::replace);
}

Track track_of_event(std::string_view header)
{
    const Json json = hive::parse_json(header, {.bytes = most_text});
    const Fields fields(json, "event");
    return {fields.name("sender"), fields.name("output"), fields.text("type")};
}

std::int64_t begun_from(std::string_view text)
{
    const Json json = hive::parse_json(text);
    return count_from(Fields(json, "beginning"), "begun_us");
}

std::optional<Summary> summary_from(std::string_view text)
try {
    const Json json = hive::parse_json(text, {.bytes = most_end_text, .depth = 4});
    const Fields fields(json, "end");
    Summary summary{
        count_from(fields, "begun_us"), time_from(fields, "duration_us"), {}, {}, shortened(fields.text("ended"))};
    for (const auto& track : fields.array("tracks"))
        summary.tracks.push_back(track_from(track));
    for (const auto& loss : fields.array("lost"))
        summary.lost.push_back(loss_from(loss));
    return summary.tracks.size() <= most_tracks && !summary.ended.empty() ? std::optional(summary) : std::nullopt;
} catch (const std::exception&) {
    return std::nullopt;
}

std::vector<Port> ports_of(const std::vector<Track>& tracks)
{
    std::vector<Port> ports;
    std::set<std::string> taken;
    std::vector<std::string> froms;
    for (std::uint32_t i = 0; i < tracks.size(); ++i) {
        const Track& track = tracks[i];
        const auto known = std::ranges::find(froms, track.from());
        if (known == froms.end()) {
            const bool alone = std::ranges::none_of(tracks, [&](const Track& other) {
                return other.output == track.output && other.sender != track.sender;
            });
            ports.push_back({port_name(track, alone, taken, ports.size() + 1), track.type, {i}});
            taken.insert(ports.back().name);
            froms.push_back(track.from());
            continue;
        }
        Port& port = ports[static_cast<std::size_t>(known - froms.begin())];
        port.tracks.push_back(i);
        if (!has_type(port.types, track.type))
            port.types += "," + track.type;
    }
    return ports;
}

}  // namespace hive::recording
