// The Stream over any connected socket of the operating system; tcp and unix share it.
#pragma once

#include "os_text.hpp"

#include <hive/transport/stream.hpp>

#include <asio/basic_stream_socket.hpp>
#include <asio/generic/stream_protocol.hpp>

namespace hive::transport {

/// With a concrete executor: a type-erased one costs every operation more cache misses.
using Socket = asio::basic_stream_socket<asio::generic::stream_protocol, asio::io_context::executor_type>;

/// @param local  the peer is on this machine
std::unique_ptr<Stream> make_socket_stream(Socket socket, std::string peer, bool local);
/// The stream of a unix socket, which passes descriptors.
std::unique_ptr<Stream> make_descriptor_stream(Socket socket, std::string peer);

/// Stream::write_now of a socket.
std::size_t write_now(Socket& socket, std::span<const asio::const_buffer> from);

/// Creates a socket that children do not inherit. Throws Errc::io.
Socket open_socket(asio::io_context& context, int family);
/// Takes over an open descriptor, and closes it on failure. Throws Errc::io.
Socket adopt_socket(asio::io_context& context, int family, int descriptor);
/// Sets an integer option, if the operating system supports it.
void set_option(int descriptor, int level, int option, int value) noexcept;

/// Buffers of local sockets: larger ones only push the bytes out of the cache between writer and reader.
inline constexpr int local_socket_buffer = 256 * 1024;

}  // namespace hive::transport
