// The available transports: each a listener and a dialer. Texts of thrown errors name the action, its object, and the
// cause.
#pragma once

#include <hive/transport/transport.hpp>

namespace hive::transport {

std::unique_ptr<Listener> listen_tcp(asio::io_context& context, const Address& address, OnConnection on_connection,
                                     const Timing& timing, const Security& security);
std::unique_ptr<Listener> listen_unix(asio::io_context& context, const Address& address, OnConnection on_connection,
                                      const Timing& timing, const Security& security);

using Milliseconds = std::chrono::milliseconds;
void dial_tcp(asio::io_context& context, const Address& address, Milliseconds deadline, OnDialed on_dialed,
              const Timing& timing, const Security& security);
void dial_unix(asio::io_context& context, const Address& address, Milliseconds deadline, OnDialed on_dialed,
               const Timing& timing, const Security& security);

}  // namespace hive::transport
