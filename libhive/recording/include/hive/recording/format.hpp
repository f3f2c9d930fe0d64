// The recording file: its records, what is known of a whole file, and the names of what is in it. FORMAT.md is the
// specification.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hive::recording {

inline constexpr std::string_view file_magic = "HIVEREC1", end_magic = "HIVEDONE";
inline constexpr std::size_t prefix_size = 36, trailer_size = 16, index_entry_size = 20;
inline constexpr std::size_t most_text = 128 * 1024;  ///< of an event's header
inline constexpr std::size_t most_end_text = 16 * 1024 * 1024;
inline constexpr std::size_t most_tracks = 1000;
inline constexpr std::size_t most_body = 1 << 30;                                 ///< of an event
inline constexpr std::int64_t most_time_us = 10LL * 366 * 24 * 3600 * 1'000'000;  ///< ten years

enum class Kind : std::uint32_t {
    begin = 0x4E474542,
    event = 0x544E5645,
    end = 0x454E4F44
};  ///< "BEGN", "EVNT", "DONE"

/// What stands before the text and the body of each record.
struct Prefix {
    Kind kind = Kind::event;
    std::uint32_t track = 0;
    std::uint32_t text_size = 0, body_size = 0;
    std::int64_t time_us = 0;  ///< arrival, since the first event
    std::uint32_t text_crc = 0, body_crc = 0;

    [[nodiscard]] std::uint64_t record_size() const { return prefix_size + std::uint64_t{text_size} + body_size; }
};
std::array<std::byte, prefix_size> encode(const Prefix& prefix);
/// Nothing when its own check sum is wrong or the kind is none of the three.
std::optional<Prefix> decode(std::span<const std::byte, prefix_size> bytes);

/// CRC-32 (that of zlib and PNG).
std::uint32_t crc(std::span<const std::byte> bytes, std::uint32_t before = 0);

/// Events of one output and one type. Events name their track by its place in the list.
struct Track {
    std::string sender, output, type;
    std::int64_t events = 0;
    std::int64_t bytes = 0;         ///< of the bodies
    std::int64_t without_body = 0;  ///< recorded as headers alone, though there was a body
    std::int64_t first_us = 0, last_us = 0;

    [[nodiscard]] std::string from() const { return sender + "." + output; }
};

/// Events that should be in the file and are not.
struct Loss {
    std::string from;  ///< "camera.image"; "*": of any output
    std::string reason;
    std::int64_t events = 0;  ///< 0: not known how many
};

/// Where the first event of a track in a second of the recording is.
struct IndexEntry {
    std::uint64_t offset = 0;
    std::int64_t time_us = 0;
    std::uint32_t track = 0;
};
inline constexpr std::int64_t index_step_us = 1'000'000;

struct Summary {
    std::int64_t begun_us = 0;  ///< wall clock at the first event, since 1970; 0: there is none
    std::int64_t duration_us = 0;
    std::vector<Track> tracks;
    std::vector<Loss> lost;
    std::string ended;  ///< how the recording ended; empty: the file has no end

    [[nodiscard]] std::int64_t events() const;
    [[nodiscard]] std::int64_t bytes() const;
    [[nodiscard]] bool lossless() const { return lost.empty(); }
};
/// One line of JSON, and back; nothing when the text is something else.
std::string to_text(const Summary& summary);
std::optional<Summary> summary_from(std::string_view text);
/// The track that an event with this header belongs to. Throws hive::Error when it is no header.
Track track_of_event(std::string_view header);
/// What the text of a beginning says: wall clock, µs since 1970. Throws hive::Error when it is something else.
std::int64_t begun_from(std::string_view text);

/// Everything of one output of the recorded swarm, under the name that a replay gives it.
struct Port {
    std::string name;   ///< "image"; where several drones had an output of that name, "camera-image"
    std::string types;  ///< joined by commas
    std::vector<std::uint32_t> tracks;
};
std::vector<Port> ports_of(const std::vector<Track>& tracks);

void put_number(std::span<std::byte> to, std::uint64_t number);
std::uint64_t number_in(std::span<const std::byte> bytes);

}  // namespace hive::recording
