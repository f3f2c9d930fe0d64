// Simulates a bad line: which packets arrive, how often, when, and with which damage. Pure logic: the caller has the
// clock and the sockets.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <vector>

namespace hive::test {

/// The quality of a line in one direction. Shares of packets are from 0 to 1.
struct LineQuality {
    enum class Damage {
        bit,   ///< one flipped bit: TCP's checksum detects it, so the packet counts as lost
        words  ///< two swapped words: TCP's checksum stays equal, as with bad memory in a router
    };
    std::chrono::microseconds delay{0};
    std::chrono::microseconds jitter{0};  ///< each packet takes up to this much more or less: they may overtake
    double loss = 0, duplication = 0, corruption = 0;
    Damage damage = Damage::bit;
    double megabits = 0;                   ///< a second; 0: no limit
    std::size_t buffer_bytes = 64 * 1024;  ///< queue of a rate limit; more is lost
    bool operator==(const LineQuality&) const = default;
};

struct LineCounts {
    std::int64_t came = 0, lost = 0, overflowed = 0, duplicated = 0, damaged = 0;
};

/// One direction. The same seed and the same packets give the same fates.
class Line {
public:
    using TimePoint = std::chrono::steady_clock::time_point;
    using Packet = std::vector<unsigned char>;

    explicit Line(std::uint64_t seed) : random_(seed) {}
    void come(Packet packet, const LineQuality& quality, TimePoint now);
    /// The next packet that has arrived by now.
    std::optional<Packet> arrived(TimePoint now);
    /// When the next one arrives, if one is in flight.
    [[nodiscard]] std::optional<TimePoint> next() const;
    [[nodiscard]] const LineCounts& counts() const { return counts_; }

private:
    [[nodiscard]] bool happens(double share) { return std::uniform_real_distribution<>(0, 1)(random_) < share; }
    [[nodiscard]] std::size_t below(std::size_t count)
    {
        return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
    }
    void damage(Packet& packet, LineQuality::Damage how);
    std::optional<TimePoint> leaves(std::size_t bytes, const LineQuality& quality, TimePoint now);

    std::mt19937_64 random_;
    std::multimap<TimePoint, Packet> under_way_;
    TimePoint free_{};  ///< when the line has sent all earlier packets
    LineCounts counts_;
};

}  // namespace hive::test
