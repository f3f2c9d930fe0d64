// Writes records one after the other, and reserves space for the end before each.
#include <hive/recording/writer.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <sys/resource.h>
#include <system_error>

namespace hive::recording {
namespace {

constexpr std::uint64_t reserve_step = 1 << 20;
constexpr std::size_t end_bytes = 4096;  ///< of the end, without its names and its index
constexpr std::size_t row_bytes = 400;   ///< of a track or a loss in the end, without the names

std::uint64_t file_size_limit()
{
    rlimit limit{};
    return ::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY
               ? limit.rlim_cur
               : std::numeric_limits<std::int64_t>::max();
}

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

std::int64_t wall_us()
{
    return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

std::string reason_of(int error)
{
    return error == ENOSPC || error == EDQUOT || error == EFBIG ? "disk full" : std::strerror(error);
}

/// Files that shells and programs read automatically start with a dot.
void require_visible(const std::filesystem::path& path)
{
    for (const auto& part : path)
        if (part.string().starts_with('.') && part != "." && part != "..")
            throw std::runtime_error(path.string() + " is hidden; a recording is not");
}

File create(const WriterSettings& settings)
{
    if (settings.folder.empty()) {
        const auto path = std::filesystem::absolute(settings.path);
        return File::create(path.parent_path(), path.filename(), settings.overwrite);
    }
    require_visible(settings.path);
    return File::create(settings.folder, settings.path, settings.overwrite);
}

}  // namespace

Writer::Writer(const WriterSettings& settings)
    : file_(create(settings)), limits_(settings.limits), most_(file_size_limit())
{
    try {
        make_room(file_magic.size());
        file_.write(0, {bytes_of(file_magic)});
    } catch (const std::system_error& error) {
        std::error_code ignored;
        std::filesystem::remove(settings.folder / settings.path, ignored);
        throw std::runtime_error("nothing can be recorded into " + settings.path.string() + ": "
                                 + reason_of(error.code().value()));
    }
    end_ = file_magic.size();
    if (settings.sync.count() > 0)
        sync_ = std::jthread(
            [this, period = settings.sync](std::stop_token stop) { sync_again_and_again(std::move(stop), period); });
}

Writer::~Writer() { finish("stopped"); }

/// Reserves space for this many bytes at the end of the file, and for the end after them.
void Writer::make_room(std::uint64_t bytes)
{
    const auto upto = end_ + bytes + size_of_end();
    if (upto > most_)
        throw std::system_error(EFBIG, std::generic_category());
    if (!reserves_ || upto <= reserved_)
        return;
    for (const auto target : {std::min(std::max(upto, reserved_ + reserve_step), most_), upto})
        try {
            reserves_ = file_.reserve(reserved_, target);
            reserved_ = target;
            return;
        } catch (const std::system_error&) {
            if (target == upto)
                throw;
        }
}

std::uint64_t Writer::size_of_end() const
{
    const auto rows = summary_.tracks.size() * 2 + summary_.lost.size() + 1;  // a loss for each track may still come
    return prefix_size + end_bytes + rows * row_bytes + names_bytes_ + (index_.size() + 1) * index_entry_size
           + trailer_size;
}

/// Removes a partial record.
void Writer::write_whole(std::initializer_list<std::span<const std::byte>> parts)
try {
    file_.write(end_, parts);
} catch (const std::system_error&) {
    reserved_ = 0;
    file_.truncate(end_);
    throw;
}

bool Writer::write(Prefix prefix, std::string_view text, std::span<const std::byte> body)
{
    prefix.text_size = static_cast<std::uint32_t>(text.size());
    prefix.body_size = static_cast<std::uint32_t>(body.size());
    prefix.text_crc = crc(bytes_of(text));
    prefix.body_crc = crc(body);
    const auto head = encode(prefix);
    try {
        make_room(prefix.record_size());
        write_whole({head, bytes_of(text), body});
    } catch (const std::system_error& error) {
        failed(error.code().value());
        return false;
    }
    end_ += prefix.record_size();
    unsynced_ = true;
    return true;
}

/// Its number; most_tracks if there are too many.
std::uint32_t Writer::track_number(const Track& track)
{
    const std::tuple key(track.sender, track.output, track.type);
    if (const auto known = numbers_.find(key); known != numbers_.end())
        return known->second;
    const auto number = static_cast<std::uint32_t>(summary_.tracks.size());
    if (number == most_tracks)
        return number;
    numbers_.emplace(key, number);
    summary_.tracks.push_back({track.sender, track.output, track.type});
    indexed_.push_back(-1);
    names_bytes_ +=
        2 * 6 * (track.sender.size() + track.output.size() + track.type.size());  // 6: the longest escape of JSON
    return number;
}

void Writer::begin(Clock::time_point arrived)
{
    begun_ = arrived;
    summary_.begun_us = wall_us();
    write({.kind = Kind::begin}, nlohmann::json{{"begun_us", summary_.begun_us}}.dump(), {});
}

bool Writer::append(const Track& track, std::string_view text, std::span<const std::byte> body, bool has_body,
                    Clock::time_point arrived)
{
    look(arrived);
    if (ended().empty() && summary_.begun_us == 0)
        begin(arrived);
    if (!failure_.empty())
        ++loss(track.from(), failure_).events;
    if (!ended().empty())
        return false;
    const auto time_us =
        std::max(summary_.duration_us, std::chrono::duration_cast<std::chrono::microseconds>(arrived - begun_).count());
    const auto number = track_number(track);
    if (number == most_tracks || text.size() > most_text || body.size() > std::numeric_limits<std::uint32_t>::max()) {
        ++loss(track.from(), number == most_tracks ? "more than 1000 outputs" : "too large").events;
        return true;
    }
    const auto size = prefix_size + text.size() + body.size();
    if (limits_.bytes > 0 && end_ + size + size_of_end() > limits_.bytes) {
        finish("max_size reached");
        return false;
    }
    const auto offset = end_;
    if (write({.kind = Kind::event, .track = number, .time_us = time_us}, text, body))
        note(number, offset, time_us, body.size(), has_body);
    else
        ++loss(track.from(), failure_).events;
    return ended().empty();
}

void Writer::note(std::uint32_t number, std::uint64_t offset, std::int64_t time_us, std::size_t body_size,
                  bool has_body)
{
    Track& track = summary_.tracks[number];
    if (track.events++ == 0)
        track.first_us = time_us;
    track.last_us = summary_.duration_us = time_us;
    track.bytes += static_cast<std::int64_t>(body_size);
    track.without_body += has_body ? 0 : 1;
    if (const auto second = time_us / index_step_us; std::exchange(indexed_[number], second) != second)
        index_.push_back({offset, time_us, number});
}

Loss& Writer::loss(const std::string& from, const std::string& reason)
{
    const auto known = std::ranges::find_if(
        summary_.lost, [&](const Loss& loss) { return loss.from == from && loss.reason == reason; });
    return known == summary_.lost.end() ? summary_.lost.emplace_back(Loss{from, reason, 0}) : *known;
}

void Writer::look(Clock::time_point now)
{
    if (!ended().empty())
        return;
    if (const int error = sync_error_.exchange(0))
        failed(error);
    else if (limits_.duration.count() > 0 && summary_.begun_us != 0 && now - begun_ >= limits_.duration)
        finish("max_duration reached");
}

/// The end fills all of its reserved space, so that it can be rewritten if more is lost.
void Writer::failed(int error)
{
    failure_ = reason_of(error);
    summary_.ended = failure_;
    write_end(size_of_end());
}

void Writer::finish(const std::string& how)
{
    if (ended().empty())
        summary_.ended = how;
    write_end(end_size_);
}

void Writer::write_end(std::uint64_t least_size)
{
    std::vector<std::byte> index(index_.size() * index_entry_size);
    for (std::size_t i = 0; i < index_.size(); ++i) {
        const auto entry = std::span(index).subspan(i * index_entry_size, index_entry_size);
        put_number(entry.subspan(0, 8), index_[i].offset);
        put_number(entry.subspan(8, 8), static_cast<std::uint64_t>(index_[i].time_us));
        put_number(entry.subspan(16, 4), index_[i].track);
    }
    std::string text = to_text(summary_);
    const auto bare_size = prefix_size + text.size() + index.size() + trailer_size;
    end_size_ = std::max<std::uint64_t>(bare_size, least_size);
    text.append(end_size_ - bare_size, ' ');
    const Prefix prefix{Kind::end,
                        0,
                        static_cast<std::uint32_t>(text.size()),
                        static_cast<std::uint32_t>(index.size()),
                        summary_.duration_us,
                        crc(bytes_of(text)),
                        crc(index)};
    std::array<std::byte, 8> place{};
    put_number(place, end_);
    try {
        write_whole({encode(prefix), bytes_of(text), index, place, bytes_of(end_magic)});
        file_.truncate(end_ + end_size_);  // releases the reserved space
    } catch (const std::system_error& error) {
        if (failure_.empty())
            failure_ = reason_of(error.code().value());
    }
    unsynced_ = true;
}

void Writer::sync_again_and_again(std::stop_token stop, std::chrono::milliseconds period)
{
    std::unique_lock lock(mutex_);
    for (bool last = false; !last;) {
        last = stop.stop_requested();
        if (!last)
            sleeping_.wait_for(lock, stop, period, [] { return false; });
        if (unsynced_.exchange(false))
            if (const int error = file_.sync())
                sync_error_ = error;
    }
}

}  // namespace hive::recording
