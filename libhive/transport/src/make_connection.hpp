// How listeners and dialers make a Connection out of their Stream.
#pragma once

#include <hive/transport/connection.hpp>

namespace hive::transport {

/// As Connection::create. `admission` is let go when the peer has said hello and was opened, or when the connection
/// ends.
std::shared_ptr<Connection> make_connection(asio::io_context& context, std::unique_ptr<Stream> stream,
                                            const Timing& timing, std::shared_ptr<void> admission);

}  // namespace hive::transport
