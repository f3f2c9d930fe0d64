// Writes a recording: event by event, each whole or not at all, with an end that says what is missing.
#pragma once

#include <hive/recording/file.hpp>
#include <hive/recording/format.hpp>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <thread>
#include <tuple>

namespace hive::recording {

struct Limits {
    std::uint64_t bytes = 0;               ///< of the whole file; 0: none
    std::chrono::microseconds duration{};  ///< since the first event; 0: none
};

struct WriterSettings {
    std::filesystem::path path;
    /// Where the path is seen from, and what it must stay below, naming nothing hidden. Empty: it may be anywhere, but
    /// be no symbolic link.
    std::filesystem::path folder = {};
    bool overwrite = false;
    Limits limits;
    std::chrono::milliseconds sync{1000};  ///< how often what was written is sent to the disk; 0: when the system likes
};

/// Every event is with the operating system when append() returns, so killing the process loses none of them; a power
/// failure loses what came after the last sync. Space for the end is taken ahead: a full disk does not keep the file
/// from being ended properly. For one thread. Calls do not throw once it is made: what the disk refuses ends the
/// recording, and is counted.
class Writer {
public:
    using Clock = std::chrono::steady_clock;

    /// @throws std::runtime_error  the file is there, the folder is not, or the disk has no room
    explicit Writer(const WriterSettings& settings);
    /// Ends it properly, if that has not been done.
    ~Writer();
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    void limits(const Limits& limits) { limits_ = limits; }
    /// @param text  the event's header; @param has_body  false: there was a body that was not received
    /// @return false when the recording has ended; after a failure (not after a limit) the event is counted as lost
    bool append(const Track& track, std::string_view text, std::span<const std::byte> body, bool has_body,
                Clock::time_point arrived);
    /// Notes what others know to be missing; the same cause again replaces the number.
    void lost(const std::string& from, const std::string& reason, std::int64_t events)
    {
        loss(from, reason).events = events;
    }
    /// Looks whether time is up or the disk has failed; for when no event comes.
    void look(Clock::time_point now);
    /// Writes the end; again when more was lost since. @param how  for people: "stopped"
    void finish(const std::string& how);

    /// How it has ended; empty: it goes on.
    [[nodiscard]] const std::string& ended() const noexcept { return summary_.ended; }
    /// Why the disk refused; empty: it did not.
    [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
    [[nodiscard]] const Summary& summary() const noexcept { return summary_; }
    /// Bytes of the file so far, without its end.
    [[nodiscard]] std::uint64_t size() const noexcept { return end_; }

private:
    std::uint32_t track_number(const Track& track);
    bool write(Prefix prefix, std::string_view text, std::span<const std::byte> body);
    void write_whole(std::initializer_list<std::span<const std::byte>> parts);
    void make_room(std::uint64_t bytes);
    [[nodiscard]] std::uint64_t size_of_end() const;
    void begin(Clock::time_point arrived);
    void note(std::uint32_t track, std::uint64_t offset, std::int64_t time_us, std::size_t body_size, bool has_body);
    Loss& loss(const std::string& from, const std::string& reason);
    void failed(int error);
    void write_end(std::uint64_t least_size);
    void sync_again_and_again(std::stop_token stop, std::chrono::milliseconds period);

    File file_;
    Limits limits_;
    std::uint64_t most_;          ///< what the system lets a file of this process grow to
    std::uint64_t end_ = 0;       ///< of the last whole record
    std::uint64_t end_size_ = 0;  ///< of what ends the file now; 0: nothing yet
    std::uint64_t reserved_ = 0;  ///< disk space taken, bytes from the beginning of the file
    bool reserves_ = true;
    Summary summary_;
    std::string failure_;
    std::size_t names_bytes_ = 0;  ///< what the names in the end take at most
    std::map<std::tuple<std::string, std::string, std::string>, std::uint32_t> numbers_;
    std::vector<std::int64_t> indexed_;  ///< by track: the second of its last index entry
    std::vector<IndexEntry> index_;
    Clock::time_point begun_{};
    std::atomic<bool> unsynced_ = false;
    std::atomic<int> sync_error_ = 0;
    std::mutex mutex_;
    std::condition_variable_any sleeping_;
    std::jthread sync_;  ///< declared last: it ends first
};

}  // namespace hive::recording
