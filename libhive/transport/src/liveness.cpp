// Judges a peer by its bytes and pauses.
#include "liveness.hpp"

#include <algorithm>

namespace hive::transport {
namespace {

constexpr std::int64_t least_bytes_per_second = 64 * 1024;

}  // namespace

void Liveness::pinged(Clock::time_point now)
{
    probed_ = now;
    unanswered_ = true;
}

void Liveness::answered(Clock::time_point sent, std::size_t unanswered)
{
    received_ = sent;
    unanswered_ = unanswered > 0;
}

void Liveness::heard(Clock::time_point now, std::size_t bytes, bool fresh)
{
    heard_ = now;
    if (fresh) {
        window_ = now;
        window_bytes_ = 0;
    }
    window_bytes_ += bytes;
}

void Liveness::excuse(Clock::duration late)
{
    started_ += late;
    heard_ += late;
    window_ += late;
}

std::optional<Error> Liveness::verdict(Clock::time_point now, bool inside)
{
    if (!hello_) {
        if (now >= started_ + timing_.first_packet)
            return Error(Errc::timeout, "no hello within " + duration_text(timing_.first_packet),
                         "see why it does not answer: hivectl explain");
        return {};
    }
    if (now >= heard_ + timing_.silence)
        return Error(Errc::connection_lost, "no sign of life for " + duration_text(timing_.silence));
    if (inside && too_slow(now))
        return Error(Errc::timeout, "a packet arrived at less than 64 KiB/s for " + duration_text(timing_.stall));
    return {};
}

// Judged once per window of `stall`; a packet that is fast enough starts another window.
bool Liveness::too_slow(Clock::time_point now)
{
    if (now < window_ + timing_.stall)
        return false;
    const auto passed = std::chrono::duration_cast<std::chrono::milliseconds>(now - window_).count();
    if (static_cast<std::int64_t>(window_bytes_) < least_bytes_per_second * passed / 1000)
        return true;
    window_ = now;
    window_bytes_ = 0;
    return false;
}

Liveness::Clock::time_point Liveness::next_look(Clock::time_point now, bool inside) const
{
    auto next = hello_ ? heard_ + timing_.silence : started_ + timing_.first_packet;
    if (inside && hello_)
        next = std::min(next, window_ + timing_.stall);
    // An overdue ping waits behind bytes that the peer does not read: an earlier check would only spin.
    const auto ping = sent_ && !ping_due(now) ? *sent_ : now;
    next = std::min(next, ping + timing_.heartbeat);
    if (sent_ && !unanswered_)
        next = std::min(next, probed_ + 2 * timing_.heartbeat);
    return std::max(next, now + std::chrono::milliseconds(1));
}

std::string duration_text(std::chrono::milliseconds time)
{
    return time.count() % 1000 == 0 ? std::to_string(time.count() / 1000) + " s" : std::to_string(time.count()) + " ms";
}

}  // namespace hive::transport
