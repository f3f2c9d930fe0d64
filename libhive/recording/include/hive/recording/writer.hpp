// Writes a recording: each event completely or not at all, with an end that lists missing events.
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
    /// The path is relative to this folder, stays in it, and has no hidden part. Empty: any path, but not a symbolic
    /// link.
    std::filesystem::path folder = {};
    bool overwrite = false;
    Limits limits;
    std::chrono::milliseconds sync{1000};  ///< interval of syncing to the disk; 0: left to the system
};

/// The operating system has every event when append() returns, so killing the process loses none; a power failure loses
/// events after the last sync. Space for the end is reserved in advance, so a full disk does not prevent a proper end.
/// For one thread. After the constructor no call throws: an error of the disk ends the recording, and lost events are
/// counted.
class Writer {
public:
    using Clock = std::chrono::steady_clock;

    /// @throws std::runtime_error  the file exists, the folder does not, or the disk is full
    explicit Writer(const WriterSettings& settings);
    /// Writes the end, unless that has been done.
    ~Writer();
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    void limits(const Limits& limits) { limits_ = limits; }
    /// @param text  the event's header; @param has_body  false: there was a body that was not received
    /// @return false when the recording has ended; after a failure (not after a limit) the event is counted as lost
    bool append(const Track& track, std::string_view text, std::span<const std::byte> body, bool has_body,
                Clock::time_point arrived);
    /// Adds events that others report missing; the same cause again replaces the number.
    void lost(const std::string& from, const std::string& reason, std::int64_t events)
    {
        loss(from, reason).events = events;
    }
    /// Checks the time limit and the disk; for times without events.
    void look(Clock::time_point now);
    /// Writes the end; again when more was lost since. @param how  for people: "stopped"
    void finish(const std::string& how);

    /// How it ended; empty: still recording.
    [[nodiscard]] const std::string& ended() const noexcept { return summary_.ended; }
    /// The error of the disk; empty: none.
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
    std::uint64_t most_;          ///< maximum file size that the system allows this process
    std::uint64_t end_ = 0;       ///< of the last whole record
    std::uint64_t end_size_ = 0;  ///< of the end that the file has now; 0: none yet
    std::uint64_t reserved_ = 0;  ///< disk space reserved, in bytes from the start of the file
    bool reserves_ = true;
    Summary summary_;
    std::string failure_;
    std::size_t names_bytes_ = 0;  ///< maximum size of the names in the end
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
