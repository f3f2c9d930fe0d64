// Reads the end first, if there is one; otherwise from record to record.
#include <hive/recording/reader.hpp>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace hive::recording {
namespace {

constexpr std::uint64_t first_record = file_magic.size();

std::string_view text_of(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string damage(std::uint64_t offset) { return "the recording is damaged at byte " + std::to_string(offset); }

}  // namespace

Reader::Reader(const std::filesystem::path& path) : file_(File::open_to_read(path)), size_(file_.size())
{
    std::array<std::byte, file_magic.size()> magic{};
    if (!file_.read(0, magic) || text_of(magic) != file_magic)
        throw std::runtime_error(path.string() + " is not a recording");
    if (!read_end())
        scan();
    at_ = first_record;
}

/// A record that is complete in the file.
std::optional<Prefix> Reader::prefix_at(std::uint64_t offset) const
{
    std::array<std::byte, prefix_size> bytes{};
    if (offset < first_record || offset > size_ || size_ - offset < prefix_size || !file_.read(offset, bytes))
        return std::nullopt;
    const auto prefix = decode(bytes);
    const bool sane = prefix && prefix->record_size() <= size_ - offset
                      && prefix->text_size <= (prefix->kind == Kind::end ? most_end_text : most_text)
                      && prefix->body_size <= most_body;
    return sane ? prefix : std::nullopt;
}

bool Reader::read_end()
{
    std::array<std::byte, trailer_size> trailer{};
    if (size_ < first_record + trailer_size || !file_.read(size_ - trailer_size, trailer))
        return false;
    return text_of(std::span(trailer).subspan(8)) == end_magic && read_end_at(number_in(std::span(trailer).first(8)));
}

bool Reader::read_end_at(std::uint64_t offset)
try {
    const auto prefix = prefix_at(offset);
    if (!prefix || prefix->kind != Kind::end || prefix->body_size % index_entry_size != 0)
        return false;
    const Record record{*prefix, offset};
    const auto summary = summary_from(text(record));
    std::vector<std::byte> index(prefix->body_size);
    body(record, index);
    if (!summary)
        return false;
    for (std::size_t at = 0; at < index.size(); at += index_entry_size) {
        const auto entry = std::span(index).subspan(at, index_entry_size);
        index_.push_back({number_in(entry.first(8)), static_cast<std::int64_t>(number_in(entry.subspan(8, 8))),
                          static_cast<std::uint32_t>(number_in(entry.subspan(16)))});
    }
    summary_ = *summary;
    end_ = offset;
    return true;
} catch (const std::runtime_error&) {
    return false;
}

/// The summary of a file without an end, from its complete records.
void Reader::scan()
{
    std::uint64_t offset = first_record;
    for (auto prefix = prefix_at(offset); prefix; prefix = prefix_at(offset)) {
        if (prefix->kind == Kind::end && read_end_at(offset)) {
            problem_ = damage(offset + prefix->record_size());  // no record follows
            return;
        }
        if (prefix->kind == Kind::end || !learn({*prefix, offset}))
            break;
        offset += prefix->record_size();
    }
    end_ = offset;
    problem_ = offset == size_
                   ? "the recording has no end; it was interrupted"
                   : "the recording has no end; it was interrupted or is damaged at byte " + std::to_string(offset);
}

bool Reader::learn(const Record& record)
try {
    const Prefix& prefix = record.prefix;
    if (prefix.kind == Kind::begin) {
        summary_.begun_us = begun_from(text(record));
        return true;
    }
    auto& tracks = summary_.tracks;
    if (prefix.track == tracks.size() && tracks.size() < most_tracks) {
        Track track = track_of_event(text(record));
        track.first_us = prefix.time_us;
        tracks.push_back(std::move(track));
    }
    if (prefix.track >= tracks.size())
        return false;
    Track& track = tracks[prefix.track];
    ++track.events;
    track.bytes += prefix.body_size;
    track.last_us = summary_.duration_us = prefix.time_us;
    return true;
} catch (const std::exception&) {  // not a header, or changed
    return false;
}

void Reader::damaged_at(std::uint64_t offset, const std::string& what)
{
    problem_ = what;
    end_ = offset;
}

std::optional<Record> Reader::next()
{
    while (at_ < end_) {
        const auto prefix = prefix_at(at_);
        if (!prefix || prefix->record_size() > end_ - at_ || prefix->kind == Kind::end
            || (prefix->kind == Kind::event && prefix->track >= summary_.tracks.size())) {
            damaged_at(at_, damage(at_));
            break;
        }
        const Record record{*prefix, std::exchange(at_, at_ + prefix->record_size())};
        if (prefix->kind == Kind::event)
            return record;
        check(record);
    }
    return std::nullopt;
}

/// Skips a record whose content is not needed.
void Reader::check(const Record& record)
try {
    static_cast<void>(text(record));
} catch (const std::runtime_error& error) {
    problem_ = error.what();
}

void Reader::seek(std::int64_t time_us)
{
    at_ = first_record;
    for (const auto& entry : index_)
        if (entry.time_us < time_us && entry.offset >= first_record && entry.offset < end_)
            at_ = std::max(at_, entry.offset);
}

std::string Reader::text(const Record& record) const
{
    std::string text(record.prefix.text_size, '\0');
    const auto bytes = std::as_writable_bytes(std::span(text));
    if (!file_.read(record.offset + prefix_size, bytes) || crc(bytes) != record.prefix.text_crc)
        throw std::runtime_error(damage(record.offset));
    return text;
}

void Reader::body(const Record& record, std::span<std::byte> to) const
{
    if (to.size() != record.prefix.body_size || !file_.read(record.offset + prefix_size + record.prefix.text_size, to)
        || crc(to) != record.prefix.body_crc)
        throw std::runtime_error(damage(record.offset));
}

}  // namespace hive::recording
