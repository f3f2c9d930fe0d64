// The recording file: its records, summary and track names. FORMAT.md is the specification.
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

/// Precedes the text and the body of each record.
struct Prefix {
    Kind kind = Kind::event;
    std::uint32_t track = 0;
    std::uint32_t text_size = 0, body_size = 0;
    std::int64_t time_us = 0;  ///< arrival, since the first event
    std::uint32_t text_crc = 0, body_crc = 0;

    [[nodiscard]] std::uint64_t record_size() const { return prefix_size + std::uint64_t{text_size} + body_size; }
};
std::array<std::byte, prefix_size> encode(const Prefix& prefix);
/// Nothing if its own check sum is wrong or the kind is not one of the three.
std::optional<Prefix> decode(std::span<const std::byte, prefix_size> bytes);

/// CRC-32 (that of zlib and PNG).
std::uint32_t crc(std::span<const std::byte> bytes, std::uint32_t before = 0);

/// Events of one output and one type. Events refer to their track by its index in the list.
struct Track {
    std::string sender, output, type;
    std::int64_t events = 0;
    std::int64_t bytes = 0;         ///< of the bodies
    std::int64_t without_body = 0;  ///< recorded without the body that they had
    std::int64_t first_us = 0, last_us = 0;

    [[nodiscard]] std::string from() const { return sender + "." + output; }
};

/// Events missing from the file.
struct Loss {
    std::string from;  ///< "camera.image"; "*": of any output
    std::string reason;
    std::int64_t events = 0;  ///< 0: unknown
};

/// The position of a track's first event in a second of the recording.
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
/// Writes and parses one line of JSON; nothing if the text is something else.
std::string to_text(const Summary& summary);
std::optional<Summary> summary_from(std::string_view text);
/// The track that an event with this header belongs to. Throws hive::Error if it is not a header.
Track track_of_event(std::string_view header);
/// The start time in the text of a BEGN record: wall clock, µs since 1970. Throws hive::Error if the text is something
/// else.
std::int64_t begun_from(std::string_view text);

/// The events of one recorded output, under the output name that a replay uses.
struct Port {
    std::string name;   ///< "image"; if several drones had an output of that name, "camera-image"
    std::string types;  ///< joined by commas
    std::vector<std::uint32_t> tracks;
};
std::vector<Port> ports_of(const std::vector<Track>& tracks);

void put_number(std::span<std::byte> to, std::uint64_t number);
std::uint64_t number_in(std::span<const std::byte> bytes);

}  // namespace hive::recording
