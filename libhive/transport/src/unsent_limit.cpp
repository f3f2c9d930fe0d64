// Uses TCP's own estimate of the rate of a path: one window per round trip.
#include "unsent_limit.hpp"

#include "socket_stream.hpp"

#include <hive/protocol/defended.hpp>

#include <algorithm>

#include <netinet/in.h>
#include <netinet/tcp.h>

namespace hive::transport {
namespace {

constexpr std::chrono::milliseconds often_enough{100};
constexpr double covered_s = 0.05;  // longer than waking up and writing again takes, even on a busy machine

}  // namespace

int unsent_limit(double bytes_per_second) noexcept
{
    const double bytes = std::clamp<double>(bytes_per_second * covered_s, UnsentLimit::least, UnsentLimit::most);
    return static_cast<int>(bytes);
}

bool UnsentLimit::wanted() noexcept
{
    static const bool wanted = defended("unsent-limit");
    return wanted;
}

void UnsentLimit::fit(int descriptor) noexcept
{
    const auto now = std::chrono::steady_clock::now();
    if (!wanted() || (fitted_ && now < *fitted_ + often_enough))
        return;
    fitted_ = now;
    tcp_info told{};
    socklen_t size = sizeof told;
    if (::getsockopt(descriptor, IPPROTO_TCP, TCP_INFO, &told, &size) != 0 || told.tcpi_rtt == 0)
        return;
    const double window = static_cast<double>(told.tcpi_snd_cwnd) * told.tcpi_snd_mss;
    const int limit = unsent_limit(window / (told.tcpi_rtt * 1e-6));  // the round trip is in microseconds
    if (limit != limit_)
        set_option(descriptor, IPPROTO_TCP, TCP_NOTSENT_LOWAT, limit_ = limit);
}

}  // namespace hive::transport
