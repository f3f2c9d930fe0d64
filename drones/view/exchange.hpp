// Holds the newest image for all viewers. An image that no viewer requested in time is dropped.
#pragma once

#include "image.hpp"

#include <chrono>
#include <cstdint>
#include <deque>

namespace view {

/// From any thread; no call waits for another's work.
class Exchange {
public:
    using Time = std::chrono::steady_clock::time_point;
    struct Newest {
        std::shared_ptr<const Image> image;  ///< never null
        std::uint64_t number = 0;            ///< counts images, from 1; 0: none yet
        Time since{};                        ///< when it was put
        std::uint64_t version = 0;           ///< also counts updates of the text on an image

        /// Are images still arriving? False after two seconds and twice the usual interval without one.
        [[nodiscard]] bool going_on(Time now) const;
    };
    /// Interval of updating the text on the last image while there is a viewer.
    static constexpr std::chrono::milliseconds caption_every{1000};

    /// @param first  returned until there is an image
    explicit Exchange(std::shared_ptr<const Image> first) : newest_{std::move(first)} {}
    void put(std::shared_ptr<const Image> image, Time now = std::chrono::steady_clock::now());
    /// Viewers call this repeatedly, which also keeps the age on the last image up to date.
    [[nodiscard]] Newest newest(Time now = std::chrono::steady_clock::now()) const;

private:
    mutable std::mutex mutex_;
    mutable Newest newest_;
    mutable Time captioned_{};  ///< when its text was last due
};

/// Images per second, over the last two seconds, or since the previous one if that is longer ago. For one thread.
class Rate {
public:
    using Time = Exchange::Time;
    /// Counts one; the rate with it, 0 if it is the only one.
    double count(Time now);

private:
    std::deque<Time> times_;
};

}  // namespace view
