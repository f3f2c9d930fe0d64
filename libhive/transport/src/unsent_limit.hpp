// Limits the kernel's unsent bytes: packets should wait in our lanes, where control overtakes and the oldest is
// dropped.
#pragma once

#include <chrono>
#include <optional>

namespace hive::transport {

/// The bytes that a path of this rate carries in 50 ms, within bounds: on a slow path, 128 KiB would be seconds of age.
int unsent_limit(double bytes_per_second) noexcept;

/// For one TCP connection to another machine.
class UnsentLimit {
public:
    static constexpr int most = 128 * 1024;  ///< 1 ms of gigabit Ethernet
    static constexpr int least = 16 * 1024;

    /// False only in a twin of a test.
    static bool wanted() noexcept;
    /// To be called when the kernel takes no more: only then does TCP know the rate of the path.
    void fit(int descriptor) noexcept;

private:
    std::optional<std::chrono::steady_clock::time_point> fitted_;
    int limit_ = most;
};

}  // namespace hive::transport
