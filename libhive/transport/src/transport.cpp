// The table of transports.
#include "schemes.hpp"

#include <hive/protocol/defended.hpp>

#include <array>

namespace hive::transport {
namespace {

struct Scheme {
    Address::Scheme scheme;
    decltype(&listen_tcp) listen;
    decltype(&dial_tcp) dial;
};

constexpr std::array schemes{
    Scheme{Address::Scheme::unix_socket, listen_unix, dial_unix},
    Scheme{Address::Scheme::tcp, listen_tcp, dial_tcp},
};

const Scheme& scheme_of(const Address& address)
{
    for (const auto& scheme : schemes)
        if (scheme.scheme == address.scheme)
            return scheme;
    throw Error(Errc::invalid_argument, "unknown address scheme");
}

/// An infinite time, if a test switches its defence off.
Timing with_defences(Timing timing)
{
    constexpr std::chrono::hours never(1);
    if (!defended("heartbeats"))
        timing.silence = never;
    if (!defended("hello-deadline"))
        timing.first_packet = never;
    if (!defended("progress"))
        timing.stall = never;
    return timing;
}

}  // namespace

std::unique_ptr<Listener> listen(asio::io_context& context, const Address& address, OnConnection on_connection,
                                 Timing timing, Security security)
{
    return scheme_of(address).listen(context, address, std::move(on_connection), with_defences(timing), security);
}

void dial(asio::io_context& context, const Address& address, std::chrono::milliseconds deadline, OnDialed on_dialed,
          Timing timing, Security security)
{
    scheme_of(address).dial(context, address, deadline, std::move(on_dialed), with_defences(timing), security);
}

}  // namespace hive::transport
