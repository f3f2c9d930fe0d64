// Holds the newest picture for all viewers. A picture that nobody looked at in time is dropped.
#pragma once

#include "picture.hpp"

#include <chrono>
#include <cstdint>
#include <deque>

namespace view {

/// From any thread; nobody ever waits here for somebody else's work.
class Exchange {
public:
    using Time = std::chrono::steady_clock::time_point;
    struct Newest {
        std::shared_ptr<const Picture> picture;  ///< never null
        std::uint64_t number = 0;                ///< counts what was put, from 1; 0: there was none yet
        Time since{};                            ///< when it was put
        std::uint64_t version = 0;               ///< also counts how often the text on pictures was written anew

        /// Do pictures still come? Not when none came for two seconds and twice as long as usual.
        [[nodiscard]] bool going_on(Time now) const;
    };
    /// So often is the text on a picture written anew when no more come, while somebody looks.
    static constexpr std::chrono::milliseconds caption_every{1000};

    /// @param first  what is found until a picture is put
    explicit Exchange(std::shared_ptr<const Picture> first) : newest_{std::move(first)} {}
    void put(std::shared_ptr<const Picture> picture, Time now = std::chrono::steady_clock::now());
    /// Whoever looks calls this again and again: that is what keeps the age on a picture true that is the last one.
    [[nodiscard]] Newest newest(Time now = std::chrono::steady_clock::now()) const;

private:
    mutable std::mutex mutex_;
    mutable Newest newest_;
    mutable Time captioned_{};  ///< when its text was last to be written
};

/// How many a second, over the last two seconds, or since the one before if that is longer ago. For one thread.
class Rate {
public:
    using Time = Exchange::Time;
    /// Counts one; the rate with it, 0 if it is the only one.
    double count(Time now);

private:
    std::deque<Time> times_;
};

}  // namespace view
