// Listens and dials at an Address of any transport.
#pragma once

#include <hive/result.hpp>
#include <hive/transport/address.hpp>
#include <hive/transport/connection.hpp>

#include <functional>
#include <memory>

namespace hive::transport {

/// Accepts peers until it is destroyed. On the network side.
class Listener {
public:
    virtual ~Listener() = default;
    /// The address with the actual port.
    [[nodiscard]] virtual Address address() const = 0;
};

using OnConnection = std::function<void(std::shared_ptr<Connection>)>;
using OnDialed = std::function<void(Result<std::shared_ptr<Connection>>)>;

/// On tcp a peer has to prove a key of `security` before there is a connection, within `timing.first_packet`. A unix
/// socket is created with mode 0600, and replaces a stale one only if no listener answers there; peers of another uid
/// are closed. A taken TCP port is Errc::name_taken. When descriptors run out, accepting pauses for 100 ms at a time
/// and nothing else is affected. At most 64 connections may be without a hello at once; the next ones wait in the
/// kernel's queue.
std::unique_ptr<Listener> listen(asio::io_context& context, const Address& address, OnConnection on_connection,
                                 Timing timing = {}, Security security = {});

/// False: an address in numbers that this machine does not have, so that it cannot listen there.
bool is_of_this_machine(const Address& address);

/// The handler is called once, never before dial() returns, at the latest after `deadline`. Failure is
/// Errc::unreachable or Errc::timeout with the address in the text; Errc::not_permitted when the two ends' keys do not
/// match. Host names are looked up without blocking other work.
void dial(asio::io_context& context, const Address& address, std::chrono::milliseconds deadline, OnDialed on_dialed,
          Timing timing = {}, Security security = {});

}  // namespace hive::transport
