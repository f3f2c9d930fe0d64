// Handshake, reading and writing over a non-blocking socket.
#include "tls_stream.hpp"

#include <hive/protocol/packet.hpp>

#include <asio/error.hpp>
#include <asio/post.hpp>

#include <algorithm>
#include <array>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <sys/socket.h>

namespace hive::transport {
namespace {

constexpr std::size_t record = 16 * 1024;          // of TLS: the unit of encryption
constexpr std::size_t most_written = 16 * record;  // encrypted before it is sent
constexpr std::size_t most_read = 16 * record;     // of data, before other connections are served
/// A TLS hello with one key has about 400 bytes.
constexpr std::uint64_t most_before_key = 4096;

class TlsCategory final : public std::error_category {
public:
    [[nodiscard]] const char* name() const noexcept override { return "tls"; }
    [[nodiscard]] std::string message(int reason) const override
    {
        const char* text = ::ERR_reason_error_string(ERR_PACK(ERR_LIB_SSL, 0, reason));
        return text ? text : "TLS error " + std::to_string(reason);
    }
};

}  // namespace

const std::error_category& tls_category()
{
    static const TlsCategory category;
    return category;
}

TlsStream::TlsStream(Socket socket, TlsEnd end, KeyTalk talk, std::string peer, bool local)
    : socket_(std::move(socket)),
      talk_(std::move(talk)),
      peer_(std::move(peer)),
      local_(local),
      turn_{.socket = socket_.native_handle()},
      session_(make_tls_session(end, turn_, talk_, outgoing_))
{
}

Credentials TlsStream::credentials() const
{
    const auto& key = talk_.keys.at(talk_.shown.value());
    return {key.role, key.id};
}

void TlsStream::post(Handler handler, std::error_code error, std::size_t bytes)
{
    asio::post(socket_.get_executor(), [handler = std::move(handler), error, bytes] { handler(error, bytes); });
}

/// The error after a call into OpenSSL, on the calling thread. None: it waits for the peer.
std::error_code TlsStream::failure(int result)
{
    const int kind = ::SSL_get_error(session_.get(), result);
    if (kind == SSL_ERROR_WANT_READ || kind == SSL_ERROR_WANT_WRITE)
        return {};
    if (kind == SSL_ERROR_ZERO_RETURN)
        return asio::error::eof;
    if (kind == SSL_ERROR_SYSCALL) {
        const int number = errno;
        return number == 0 ? std::error_code(asio::error::eof) : std::error_code(number, std::generic_category());
    }
    reason_ = ERR_GET_REASON(::ERR_peek_error());
    return {reason_ == 0 ? SSL_R_BAD_LENGTH : reason_, tls_category()};
}

void TlsStream::handshake(Handler handler)
{
    asio::post(socket_.get_executor(), [this, handler = std::move(handler)]() mutable { shake(std::move(handler)); });
}

void TlsStream::shake(Handler handler)
{
    look_for_plain_peer();
    turn_.begin();
    ::ERR_clear_error();
    errno = 0;
    const int result = ::SSL_do_handshake(session_.get());
    const bool done = result == 1;
    auto error = done ? std::error_code() : failure(result);
    if (!done && !error && ::BIO_number_read(::SSL_get_rbio(session_.get())) > most_before_key)
        error = std::make_error_code(std::errc::message_size);
    // Remaining bytes are sent even after a failure: the alert tells the peer the reason.
    flush(0, [this, done, error, handler = std::move(handler)](std::error_code unsent, std::size_t) mutable {
        shake_on(done, error ? error : unsent, std::move(handler));
    });
}

void TlsStream::shake_on(bool done, std::error_code error, Handler handler)
{
    if (done && !error)
        ::SSL_set_read_ahead(session_.get(), 1);  // from now on reads many records at once
    if (done || error)
        return handler(error, 0);
    await_turn([this, handler = std::move(handler)](std::error_code failed) mutable {
        if (failed)
            return handler(failed, 0);
        shake(std::move(handler));
    });
}

void TlsStream::await_turn(std::function<void(std::error_code)> more)
{
    if (turn_.left > 0)
        return socket_.async_wait(Socket::wait_read, std::move(more));
    asio::post(socket_.get_executor(), [more = std::move(more)] { more({}); });
}

void TlsStream::look_for_plain_peer()
{
    std::array<char, protocol::magic.size()> first{};
    const bool nothing_read = ::BIO_number_read(::SSL_get_rbio(session_.get())) == 0;
    plain_peer_ = plain_peer_
                  || (nothing_read
                      && ::recv(socket_.native_handle(), first.data(), first.size(), MSG_PEEK | MSG_DONTWAIT)
                             == static_cast<ssize_t>(first.size())
                      && first == protocol::magic);
}

TlsStream::Step TlsStream::decrypt(asio::mutable_buffer into)
{
    turn_.begin();
    const auto most = std::min(into.size(), most_read);
    Step step;
    while (step.bytes < most && !turn_.flooded()) {
        ::ERR_clear_error();
        errno = 0;
        std::size_t bytes = 0;
        const int result =
            ::SSL_read_ex(session_.get(), static_cast<char*>(into.data()) + step.bytes, most - step.bytes, &bytes);
        if (result != 1) {
            if (step.bytes == 0)
                step.error = failure(result);
            if (step.error.category() == tls_category())
                static_cast<void>(send());  // the alert for the peer
            break;                          // an error is reported again by the next call
        }
        step.bytes += bytes;
        turn_.brought(bytes);
    }
    if (turn_.flooded())
        step.error = {SSL_R_TOO_MANY_KEY_UPDATES, tls_category()};
    return step;
}

void TlsStream::read_some(asio::mutable_buffer into, Handler handler)
{
    if (!socket_.is_open())
        return post(std::move(handler), asio::error::operation_aborted, 0);
    if (const auto step = decrypt(into); !step.waits())
        return post(std::move(handler), step.error, step.bytes);
    wait_to_read(into, std::move(handler));
}

void TlsStream::wait_to_read(asio::mutable_buffer into, Handler handler)
{
    await_turn([this, into, handler = std::move(handler)](std::error_code failed) mutable {
        if (failed || !socket_.is_open())
            return handler(asio::error::operation_aborted, 0);
        const auto step = decrypt(into);
        if (step.waits())
            return wait_to_read(into, std::move(handler));
        handler(step.error, step.bytes);
    });
}

std::error_code TlsStream::encrypt(const void* bytes, std::size_t size)
{
    ::ERR_clear_error();
    std::size_t written = 0;
    const int result = ::SSL_write_ex(session_.get(), bytes, size, &written);
    if (result == 1)
        return {};
    const auto error = failure(result);
    return error ? error : asio::error::connection_aborted;  // writing to memory never waits
}

/// Small pieces share a record; large ones are encrypted in place.
TlsStream::Step TlsStream::encrypt(std::span<const asio::const_buffer> from)
{
    Step step;
    staged_.clear();
    for (const auto& buffer : from) {
        const auto* at = static_cast<const unsigned char*>(buffer.data());
        for (std::size_t left = buffer.size(); left > 0 && step.bytes < most_written && !step.error;) {
            std::size_t taken = std::min(left, record - staged_.size());
            if (staged_.empty() && left >= record) {
                taken = std::min(left, most_written - step.bytes) / record * record;
                if (taken == 0)
                    taken = std::min(left, most_written - step.bytes);
                step.error = encrypt(at, taken);
            } else {
                staged_.insert(staged_.end(), at, at + taken);
            }
            if (staged_.size() == record) {
                step.error = encrypt(staged_.data(), staged_.size());
                staged_.clear();
            }
            at += taken;
            left -= taken;
            step.bytes += taken;
        }
    }
    if (!staged_.empty() && !step.error)
        step.error = encrypt(staged_.data(), staged_.size());
    return step;
}

void TlsStream::write_some(std::span<const asio::const_buffer> from, Handler handler)
{
    if (!socket_.is_open())
        return post(std::move(handler), asio::error::operation_aborted, 0);
    const auto step = encrypt(from);
    if (step.error)
        return post(std::move(handler), step.error, 0);
    flush(step.bytes, std::move(handler));
}

/// Sends as much as the operating system takes now; no error and outgoing_ not empty: it takes no more.
std::error_code TlsStream::send()
{
    while (sent_ < outgoing_.size()) {
        const auto bytes = ::send(socket_.native_handle(), outgoing_.data() + sent_, outgoing_.size() - sent_,
                                  MSG_DONTWAIT | MSG_NOSIGNAL);
        if (bytes < 0 && errno == EINTR)
            continue;
        if (bytes < 0)
            return errno == EAGAIN || errno == EWOULDBLOCK ? std::error_code()
                                                           : std::error_code(errno, std::generic_category());
        sent_ += static_cast<std::size_t>(bytes);
    }
    outgoing_.clear();
    sent_ = 0;
    return {};
}

void TlsStream::flush(std::size_t bytes, Handler handler)
{
    const auto error = send();
    if (error || outgoing_.empty())
        return post(std::move(handler), error, error ? 0 : bytes);
    if (!local_)
        unsent_.fit(socket_.native_handle());
    socket_.async_wait(Socket::wait_write, [this, bytes, handler = std::move(handler)](std::error_code failed) mutable {
        if (failed || !socket_.is_open())
            return handler(asio::error::operation_aborted, 0);
        flush(bytes, std::move(handler));
    });
}

void TlsStream::close() noexcept
{
    std::error_code ignored;
    socket_.close(ignored);
}

}  // namespace hive::transport
