// A recording, as it is and with its check sums put right: every record lies in the file, every size is believed only
// then, and what its end says can be said again. Input: the bytes of the file.
#include "memory_file.hpp"
#include "require.hpp"

#include <hive/recording/reader.hpp>

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using hive::fuzz::require;
using namespace hive::recording;

std::uint32_t number_at(const std::string& bytes, std::size_t at)
{
    return static_cast<std::uint32_t>(number_in(std::as_bytes(std::span(bytes)).subspan(at, 4)));
}

void put_crc(std::string& bytes, std::size_t at, std::size_t from, std::size_t size)
{
    const auto all = std::as_writable_bytes(std::span(bytes));
    put_number(all.subspan(at, 4), crc(all.subspan(from, size)));
}

/// With the check sums that its records should have: a fuzzer does not guess those.
std::string with_right_sums(std::string bytes)
{
    for (std::size_t at = file_magic.size(); bytes.size() >= at + prefix_size;) {
        const std::size_t text = number_at(bytes, at + 8), body = number_at(bytes, at + 12);
        const auto contents = at + prefix_size;
        if (bytes.size() - contents < text || bytes.size() - contents - text < body)
            break;
        put_crc(bytes, at + 24, contents, text);
        put_crc(bytes, at + 28, contents + text, body);
        put_crc(bytes, at + 32, at, 32);
        at = contents + text + body;
    }
    return bytes;
}

void read_contents(const Reader& reader, const Record& record)
{
    try {
        require(reader.text(record).size() == record.prefix.text_size, "a text has its size");
        std::vector<std::byte> body(record.prefix.body_size);
        reader.body(record, body);
    } catch (const std::runtime_error&) {  // other bytes than were written
    }
}

void read_events(Reader& reader)
{
    std::uint64_t last = 0;
    while (const auto record = reader.next()) {
        require(record->offset > last || last == 0, "records come one after the other");
        require(record->offset + record->prefix.record_size() <= reader.size(), "a record lies in the file");
        require(record->prefix.track < reader.summary().tracks.size(), "an event has a track");
        require(record->prefix.time_us >= 0 && record->prefix.time_us <= most_time_us, "a time is possible");
        last = record->offset;
        read_contents(reader, *record);
    }
}

void read(const std::string& bytes)
{
    const hive::fuzz::MemoryFile memory(bytes);
    try {
        Reader reader(memory.path());
        const auto& summary = reader.summary();
        require(summary.tracks.size() <= most_tracks, "there are not too many tracks");
        require(ports_of(summary.tracks).size() <= summary.tracks.size(), "tracks have ports");
        if (!summary.ended.empty())
            require(summary_from(to_text(summary)).has_value(), "what an end says can be said again");
        read_events(reader);
        reader.seek(1'000'000);
        if (const auto record = reader.next())
            read_contents(reader, *record);
    } catch (const std::runtime_error&) {  // no recording
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    const std::string file(reinterpret_cast<const char*>(bytes), size);
    read(file);
    read(with_right_sums(file));
    return 0;
}
