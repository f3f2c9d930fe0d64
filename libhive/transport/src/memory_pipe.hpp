// Two connected Streams inside this process: bytes through bounded memory, no sockets.
#pragma once

#include <hive/transport/stream.hpp>

#include <utility>

namespace hive::transport {

/// Each end belongs to the thread of its context; the two may be different threads.
std::pair<std::unique_ptr<Stream>, std::unique_ptr<Stream>>
make_memory_pipe(asio::io_context& first, asio::io_context& second, const std::string& peer);

}  // namespace hive::transport
