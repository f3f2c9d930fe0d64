// Draws the fate of each packet at random, and queues it until its arrival.
#include "line.hpp"

#include <algorithm>

namespace hive::test {
namespace {

constexpr std::size_t headers = 52;  // IPv4 and TCP with time stamps: only their payload is damaged

}  // namespace

void Line::come(Packet packet, const LineQuality& quality, TimePoint now)
{
    ++counts_.came;
    if (happens(quality.loss)) {
        ++counts_.lost;
        return;
    }
    const auto left = leaves(packet.size(), quality, now);
    if (!left) {
        ++counts_.overflowed;
        return;
    }
    if (happens(quality.corruption))
        damage(packet, quality.damage);
    const auto arrival = [&] {
        const auto most = static_cast<double>(quality.jitter.count());
        const auto deviation = std::uniform_real_distribution<>(-most, most)(random_);
        return *left + quality.delay + std::chrono::microseconds(static_cast<std::int64_t>(deviation));
    };
    if (happens(quality.duplication)) {
        ++counts_.duplicated;
        under_way_.emplace(arrival(), packet);
    }
    under_way_.emplace(arrival(), std::move(packet));
}

void Line::damage(Packet& packet, LineQuality::Damage how)
{
    const auto words = packet.size() > headers ? (packet.size() - headers) / 2 : 0;
    if (words < 2)
        return;
    ++counts_.damaged;
    const auto one = packet.begin() + static_cast<std::ptrdiff_t>(headers + 2 * below(words));
    const auto other = packet.begin() + static_cast<std::ptrdiff_t>(headers + 2 * below(words));
    if (how == LineQuality::Damage::bit)
        *one = static_cast<unsigned char>(*one ^ 1U);
    else if (one != other)
        std::swap_ranges(one, one + 2, other);
}

/// When the line has sent it; nothing if the buffer is full.
std::optional<Line::TimePoint> Line::leaves(std::size_t bytes, const LineQuality& quality, TimePoint now)
{
    if (quality.megabits <= 0)
        return now;
    const auto time_for = [&](std::size_t size) {
        const std::chrono::duration<double> time(static_cast<double>(size) * 8 / (quality.megabits * 1e6));
        return std::chrono::duration_cast<TimePoint::duration>(time);
    };
    free_ = std::max(free_, now);
    if (free_ - now > time_for(quality.buffer_bytes))
        return std::nullopt;
    return free_ += time_for(bytes);
}

std::optional<Line::Packet> Line::arrived(TimePoint now)
{
    if (under_way_.empty() || under_way_.begin()->first > now)
        return std::nullopt;
    auto packet = std::move(under_way_.begin()->second);
    under_way_.erase(under_way_.begin());
    return packet;
}

std::optional<Line::TimePoint> Line::next() const
{
    return under_way_.empty() ? std::nullopt : std::optional(under_way_.begin()->first);
}

}  // namespace hive::test
