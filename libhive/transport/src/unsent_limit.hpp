// How much the kernel may take ahead of what a network carries: what waits should wait in our lanes, where control
// overtakes and the oldest is dropped.
#pragma once

#include <chrono>
#include <optional>

namespace hive::transport {

/// What a way of so many bytes a second carries in 50 ms, within bounds: on a slow one, 128 KiB would be seconds of
/// age.
int unsent_limit(double bytes_per_second) noexcept;

/// Of one TCP connection to another machine.
class UnsentLimit {
public:
    static constexpr int most = 128 * 1024;  ///< 1 ms of gigabit Ethernet
    static constexpr int least = 16 * 1024;

    /// False in a twin of a test alone.
    static bool wanted() noexcept;
    /// To be called when the kernel takes no more: only then does TCP know what the way carries.
    void fit(int descriptor) noexcept;

private:
    std::optional<std::chrono::steady_clock::time_point> fitted_;
    int limit_ = most;
};

}  // namespace hive::transport
