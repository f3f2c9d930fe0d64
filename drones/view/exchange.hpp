// Where whoever looks finds the newest picture; what nobody looked at in time is gone.
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
    };

    /// @param first  what is found until a picture is put
    explicit Exchange(std::shared_ptr<const Picture> first) : newest_{std::move(first)} {}
    void put(std::shared_ptr<const Picture> picture, Time now = std::chrono::steady_clock::now());
    [[nodiscard]] Newest newest() const;

private:
    mutable std::mutex mutex_;
    Newest newest_;
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
