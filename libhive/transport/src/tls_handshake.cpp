// Runs the handshake, and words its errors.
#include "tls_handshake.hpp"

#include "liveness.hpp"

#include <hive/protocol/packet.hpp>

#include <asio/error.hpp>
#include <asio/post.hpp>
#include <asio/steady_timer.hpp>

#include <array>
#include <sys/socket.h>

namespace hive::transport {
namespace {

constexpr unsigned char tls_handshake_record = 0x16;
/// A fatal alert "handshake failure", by which a dialer without TLS recognises TLS.
constexpr std::array<unsigned char, 7> alert{0x15, 0x03, 0x03, 0x00, 0x02, 0x02, 0x28};

std::string ids(const std::vector<SwarmKey>& keys)
{
    std::string text;
    for (const auto& key : keys)
        if (key.role == keys.front().role)
            text += (text.empty() ? "" : " or ") + key.id;
    return text;
}

class Shaking : public std::enable_shared_from_this<Shaking> {
public:
    Shaking(Socket socket, HandshakeTerms terms, OnShaken on_shaken)
        : socket_(std::move(socket)),
          terms_(std::move(terms)),
          on_shaken_(std::move(on_shaken)),
          timer_(socket_.get_executor())
    {
    }

    void start()
    {
        timer_.expires_after(terms_.limit);
        timer_.async_wait([self = shared_from_this()](std::error_code error) {
            if (!error)
                self->fail({Errc::timeout, "it did not prove a swarm key within " + duration_text(self->terms_.limit)});
        });
        if (terms_.end == TlsEnd::dialer)
            return asio::post(socket_.get_executor(), [self = shared_from_this()] {
                if (self->on_shaken_)
                    self->begin();
            });
        wait([self = shared_from_this()] { self->on_first_bytes(); });
    }

    void cancel() noexcept
    {
        on_shaken_ = nullptr;
        end();
    }

private:
    void wait(std::function<void()> then)
    {
        socket_.async_wait(Socket::wait_read,
                           [self = shared_from_this(), then = std::move(then)](std::error_code error) {
                               if (!error && self->on_shaken_)
                                   then();
                           });
    }

    std::string peek(std::size_t most)
    {
        std::string bytes(most, '\0');
        const auto size = ::recv(socket_.native_handle(), bytes.data(), bytes.size(), MSG_PEEK | MSG_DONTWAIT);
        bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
        return bytes;
    }

    void on_first_bytes()
    {
        const auto bytes = peek(protocol::prefix_size);
        if (bytes.empty())
            return fail({Errc::connection_lost, "closed without sending anything"});
        if (static_cast<unsigned char>(bytes.front()) == tls_handshake_record)
            return begin();
        tell_plain_peer();
        if (bytes.starts_with(std::string_view(protocol::magic.data(), protocol::magic.size())))
            return fail({Errc::not_permitted, "it uses no key, and this end requires the swarm's",
                         "give it the key (hivectl key show), or start this one with --insecure"});
        fail({Errc::malformed, "it uses neither TLS nor the Hive protocol"});
    }

    /// Reads the peer's bytes first, since closing a socket with unread bytes would discard the alert.
    void tell_plain_peer()
    {
        std::array<unsigned char, 4096> rest;
        static_cast<void>(::recv(socket_.native_handle(), rest.data(), rest.size(), MSG_DONTWAIT));
        static_cast<void>(::send(socket_.native_handle(), alert.data(), alert.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
        ::shutdown(socket_.native_handle(), SHUT_WR);
    }

    void begin()
    try {
        stream_ = std::make_unique<TlsStream>(std::move(socket_), terms_.end,
                                              KeyTalk{.keys = terms_.keys, .shown = {}, .unknown_id = {}}, terms_.peer,
                                              terms_.local);
        stream_->handshake([self = shared_from_this()](std::error_code error, std::size_t) { self->on_done(error); });
    } catch (const Error& error) {
        fail(error);
    }

    void on_done(std::error_code error)
    {
        if (!on_shaken_)
            return;
        if (error || !stream_->established())
            return fail(terms_.end == TlsEnd::listener ? why_refused(error) : why_not_taken(error));
        timer_.cancel();
        std::exchange(on_shaken_, nullptr)(std::unique_ptr<Stream>(std::move(stream_)));
    }

    [[nodiscard]] Error why_refused(std::error_code error) const
    {
        const auto& talk = stream_->talk();
        if (talk.unknown_id)
            return {Errc::not_permitted,
                    "its swarm key " + *talk.unknown_id + " is not known here, where " + ids(terms_.keys) + " is"};
        if (talk.shown && error.category() == tls_category())
            return {Errc::not_permitted, "it could not prove that it has swarm key " + talk.keys[*talk.shown].id};
        if (error.category() == tls_category())
            return {Errc::not_permitted, "it uses TLS and has no swarm key"};
        return broken_off(error);
    }

    [[nodiscard]] Error why_not_taken(std::error_code error) const
    {
        const auto& key = terms_.keys.front();
        if (stream_->plain_peer())
            return {Errc::not_permitted, "it uses no key (--insecure), and this end has one",
                    "start it without --insecure, or go without a key here: HIVE_KEY=none"};
        if (error.category() == tls_category() || !error)
            return {Errc::not_permitted, "wrong swarm key: it lacks " + key.id + ", the key of this end",
                    "both ends need the same key: hivectl key show; copy the file to where it is missing"};
        return broken_off(error);
    }

    static Error broken_off(std::error_code error)
    {
        if (error == std::errc::message_size)
            return {Errc::too_large, "it sent over 4 KB without proving a swarm key"};
        if (error == asio::error::eof)
            return {Errc::connection_lost, "it ended the connection before the swarm key was proved"};
        return {Errc::connection_lost, "the connection broke before the swarm key was proved: " + error.message()};
    }

    void fail(const Error& error)
    {
        const auto told = std::exchange(on_shaken_, nullptr);
        end();
        if (told)
            told(error);
    }

    void end() noexcept
    {
        timer_.cancel();
        std::error_code ignored;
        socket_.close(ignored);
        if (stream_)
            stream_->close();
    }

    Socket socket_;  ///< until the stream takes it
    const HandshakeTerms terms_;
    OnShaken on_shaken_;
    asio::steady_timer timer_;
    std::unique_ptr<TlsStream> stream_;
};

}  // namespace

Handshake shake_hands(Socket socket, HandshakeTerms terms, OnShaken on_shaken)
{
    auto shaking = std::make_shared<Shaking>(std::move(socket), std::move(terms), std::move(on_shaken));
    shaking->start();
    auto* work = shaking.get();
    return {static_cast<void*>(work), [shaking = std::move(shaking)](void*) { shaking->cancel(); }};
}

}  // namespace hive::transport
