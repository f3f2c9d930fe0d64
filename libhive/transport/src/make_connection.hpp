// Makes a Connection from the Stream of a listener or a dialer.
#pragma once

#include <hive/transport/connection.hpp>

namespace hive::transport {

/// As Connection::create. `admission` is released when the peer has sent its hello and was opened, or when the
/// connection ends.
std::shared_ptr<Connection> make_connection(asio::io_context& context, std::unique_ptr<Stream> stream,
                                            const Timing& timing, std::shared_ptr<void> admission);

}  // namespace hive::transport
