// Listening and dialing at an Address, whatever transport it names. A further transport is its file and one line here.
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
    /// Where it listens: with the port that was chosen.
    [[nodiscard]] virtual Address address() const = 0;
};

using OnConnection = std::function<void(std::shared_ptr<Connection>)>;
using OnDialed = std::function<void(Result<std::shared_ptr<Connection>>)>;

/// Listens. On tcp a peer has to prove a key of `security` before there is a connection, within `timing.first_packet`.
/// A unix socket is made with mode 0600, over a stale one only when nobody answers there; peers of another uid
/// are closed. A taken TCP port is Errc::name_taken. When descriptors run out, accepting pauses for 100 ms at a time
/// and nothing else suffers. At most 64 connections may be without a hello at once; the next ones wait in the kernel's
/// queue.
std::unique_ptr<Listener> listen(asio::io_context& context, const Address& address, OnConnection on_connection,
                                 Timing timing = {}, Security security = {});

/// Dials; the handler is called once, never from inside, at the latest after `deadline`. Failure is Errc::unreachable
/// or Errc::timeout with the address in the text; Errc::not_permitted when the two ends' keys do not fit. Host numbers
/// are not looked up; names are, without holding up others.
void dial(asio::io_context& context, const Address& address, std::chrono::milliseconds deadline, OnDialed on_dialed,
          Timing timing = {}, Security security = {});

}  // namespace hive::transport
