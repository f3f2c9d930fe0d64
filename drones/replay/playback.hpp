// Chooses the next event of a recording, and computes when it is due.
#pragma once

#include <hive/recording/reader.hpp>

#include <chrono>
#include <optional>

namespace replay {

struct Range {
    std::int64_t from_us = 0;
    std::int64_t to_us = 0;  ///< 0: to the end
    bool operator==(const Range&) const = default;
};

/// Iterates over the events of a range, once or in a loop.
class Playback {
public:
    /// @throws std::runtime_error  no such file, or not a recording
    Playback(const std::filesystem::path& path, const Range& range);

    [[nodiscard]] const hive::recording::Reader& reader() const noexcept { return reader_; }
    /// The current event; nothing at the end.
    [[nodiscard]] const std::optional<hive::recording::Record>& current() const noexcept { return current_; }
    /// @param again  at the end the first one follows
    /// @return       then how long after the last one, in µs of the recording; otherwise 0
    std::int64_t advance(bool again);
    /// Number of repetitions.
    [[nodiscard]] std::int64_t rounds() const noexcept { return rounds_; }

private:
    void rewind();
    [[nodiscard]] std::int64_t pause_us() const;

    hive::recording::Reader reader_;
    Range range_;
    std::optional<hive::recording::Record> current_;
    std::int64_t first_us_ = 0, last_us_ = 0, distances_ = 0;  ///< of this round
    std::int64_t rounds_ = 0;
};

/// Maps times of the recording to the clock of this machine. No clock of its own: the caller passes the time.
class Timeline {
public:
    using Clock = std::chrono::steady_clock;

    /// When an event is due. Restarts the mapping at this event if time goes back, or if it is more than a second late,
    /// so that no burst follows a pause.
    Clock::time_point due(std::int64_t time_us, double speed, Clock::time_point now);
    /// Restarts the mapping at the next event: it is due after a pause of the recording, or at once.
    void restart(std::int64_t pause_us = 0);

private:
    bool started_ = false;
    std::int64_t pause_us_ = 0, first_us_ = 0, last_us_ = 0;
    double speed_ = 1;
    Clock::time_point start_{};
};

}  // namespace replay
