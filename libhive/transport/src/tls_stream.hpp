// A connected socket under TLS as a Stream. Large bodies are encrypted and sent in large pieces.
#pragma once

#include "socket_stream.hpp"
#include "tls_session.hpp"
#include "unsent_limit.hpp"

#include <vector>

namespace hive::transport {

/// OpenSSL uses the socket directly, without asio::ssl::stream, whose records of 17 KiB cost one system call and one
/// copy each.
class TlsStream final : public Stream {
public:
    /// @param talk  has the keys of the handshake
    TlsStream(Socket socket, TlsEnd end, KeyTalk talk, std::string peer, bool local);

    /// Does the handshake, before any read or write. Afterwards established() tells whether the peer has proved a key,
    /// and reason() why not.
    void handshake(Handler handler);
    [[nodiscard]] bool established() const { return proved(*session_, talk_); }
    /// OpenSSL's reason for the failure; 0: none.
    [[nodiscard]] int reason() const noexcept { return reason_; }
    /// The dialer: did the answer begin like an unencrypted packet?
    [[nodiscard]] bool plain_peer() const noexcept { return plain_peer_; }
    [[nodiscard]] const KeyTalk& talk() const noexcept { return talk_; }

    void read_some(asio::mutable_buffer into, Handler handler) override;
    void write_some(std::span<const asio::const_buffer> from, Handler handler) override;
    void close() noexcept override;
    [[nodiscard]] std::string peer() const override { return peer_; }
    [[nodiscard]] bool local() const override { return local_; }
    [[nodiscard]] Credentials credentials() const override;

private:
    struct Step {  ///< the result of a call into OpenSSL
        std::size_t bytes = 0;
        std::error_code error;
        [[nodiscard]] bool waits() const { return bytes == 0 && !error; }
    };
    /// Calls `more` in the peer's next turn: when the socket is readable, or after the other connections.
    void await_turn(std::function<void(std::error_code)> more);
    void shake(Handler handler);
    void shake_on(bool done, std::error_code error, Handler handler);
    void look_for_plain_peer();
    Step decrypt(asio::mutable_buffer into);
    std::error_code encrypt(const void* bytes, std::size_t size);
    Step encrypt(std::span<const asio::const_buffer> from);
    void wait_to_read(asio::mutable_buffer into, Handler handler);
    /// Sends the encrypted bytes; the handler gets `bytes`.
    void flush(std::size_t bytes, Handler handler);
    std::error_code send();
    std::error_code failure(int result);
    void post(Handler handler, std::error_code error, std::size_t bytes);

    Socket socket_;
    KeyTalk talk_;
    std::string peer_;
    bool local_;
    std::vector<unsigned char> outgoing_, staged_;
    std::size_t sent_ = 0;  ///< of outgoing_
    UnsentLimit unsent_;
    SocketTurn turn_;
    SslPtr session_;
    int reason_ = 0;
    bool plain_peer_ = false;
};

/// The text for a failed record authentication, for errors of a connection.
const std::error_category& tls_category();

}  // namespace hive::transport
