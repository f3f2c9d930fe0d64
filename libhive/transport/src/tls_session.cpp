// Settings and callbacks of OpenSSL, which treats a pre-shared key like a resumed session.
#include "tls_session.hpp"

#include "key_derivation.hpp"

#include <hive/error.hpp>

#include <openssl/bio.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <sys/socket.h>

namespace hive::transport {
namespace {

using ContextPtr = std::unique_ptr<SSL_CTX, decltype(&::SSL_CTX_free)>;

/// With another order OpenSSL picks a suite whose hash does not match an external key, and every handshake fails.
constexpr const char* suites = "TLS_AES_128_GCM_SHA256:TLS_CHACHA20_POLY1305_SHA256";
constexpr unsigned char suite_of_keys[] = {0x13, 0x01};  // TLS_AES_128_GCM_SHA256

KeyTalk& talk_of(SSL* session) { return *static_cast<KeyTalk*>(SSL_get_app_data(session)); }

SSL_SESSION* session_of(SSL* ssl, const SwarmKey& key)
{
    const auto secret = tls_secret(key);
    SSL_SESSION* session = ::SSL_SESSION_new();
    if (session && ::SSL_SESSION_set1_master_key(session, secret.data(), secret.size()) == 1
        && ::SSL_SESSION_set_cipher(session, ::SSL_CIPHER_find(ssl, suite_of_keys)) == 1
        && ::SSL_SESSION_set_protocol_version(session, TLS1_3_VERSION) == 1)
        return session;
    ::SSL_SESSION_free(session);
    return nullptr;
}

/// The id in an identity of our form; any other text of an unauthenticated peer is shortened and escaped, since it is
/// displayed.
std::string shown_id(std::string_view identity)
{
    std::string text;
    for (const char letter : identity.substr(identity.rfind('-') + 1).substr(0, 16))
        text += std::string_view("0123456789abcdef").find(letter) == std::string_view::npos ? '?' : letter;
    return text;
}

// Exceptions must not pass through OpenSSL; returning 0 ends the handshake.

int find_key(SSL* ssl, const unsigned char* identity, std::size_t size, SSL_SESSION** session)
try {
    *session = nullptr;
    auto& talk = talk_of(ssl);
    const std::string_view named(reinterpret_cast<const char*>(identity), size);
    for (std::size_t i = 0; i < talk.keys.size(); ++i)
        if (named == tls_identity(talk.keys[i])) {
            talk.shown = i;
            *session = session_of(ssl, talk.keys[i]);
            return *session ? 1 : 0;
        }
    if (size != 0)
        talk.unknown_id = shown_id(named);
    return 1;
} catch (...) {
    return 0;
}

int show_key(SSL* ssl, const EVP_MD* digest, const unsigned char** identity, std::size_t* size, SSL_SESSION** session)
try {
    *session = nullptr;
    // OpenSSL copies the identity before this thread can call this again.
    thread_local std::string text;
    auto& talk = talk_of(ssl);
    SSL_SESSION* mine = session_of(ssl, talk.keys.front());
    if (!mine)
        return 0;
    if (digest && digest != ::SSL_CIPHER_get_handshake_digest(::SSL_SESSION_get0_cipher(mine))) {
        ::SSL_SESSION_free(mine);
        return 1;
    }
    text = tls_identity(talk.keys.front());
    talk.shown = 0;
    *identity = reinterpret_cast<const unsigned char*>(text.data());
    *size = text.size();
    *session = mine;
    return 1;
} catch (...) {
    return 0;
}

ContextPtr make_context(TlsEnd end)
{
    ContextPtr context(::SSL_CTX_new(end == TlsEnd::listener ? ::TLS_server_method() : ::TLS_client_method()),
                       ::SSL_CTX_free);
    if (!context || ::SSL_CTX_set_min_proto_version(context.get(), TLS1_3_VERSION) != 1
        || ::SSL_CTX_set_ciphersuites(context.get(), suites) != 1)
        throw Error(Errc::failed, "OpenSSL offers no TLS 1.3");
    ::SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
    // Packets have their sizes: a truncated connection is recognised without TLS's close_notify.
    ::SSL_CTX_set_options(context.get(), SSL_OP_IGNORE_UNEXPECTED_EOF | SSL_OP_NO_TICKET);
    ::SSL_CTX_set_num_tickets(context.get(), 0);
    ::SSL_CTX_set_default_read_buffer_len(context.get(), SocketTurn::most);
    if (end == TlsEnd::listener) {
        ::SSL_CTX_set_psk_find_session_callback(context.get(), find_key);
        return context;
    }
    ::SSL_CTX_set_psk_use_session_callback(context.get(), show_key);
    // Without certificate authorities no certificate is valid: a listener that sends one instead of using the key is
    // refused.
    ::SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
    return context;
}

SSL_CTX* context_of(TlsEnd end)
{
    static const ContextPtr listener = make_context(TlsEnd::listener), dialer = make_context(TlsEnd::dialer);
    return (end == TlsEnd::listener ? listener : dialer).get();
}

using MethodPtr = std::unique_ptr<BIO_METHOD, decltype(&::BIO_meth_free)>;

MethodPtr new_method(int type, const char* name, long (*control)(BIO*, int, long, void*))
{
    MethodPtr method(::BIO_meth_new(::BIO_get_new_index() | type, name), ::BIO_meth_free);
    if (!method || ::BIO_meth_set_ctrl(method.get(), control) != 1)
        throw Error(Errc::failed, "no memory for a TLS session");
    return method;
}

BIO* new_bio(const MethodPtr& method, void* data)
{
    BIO* bio = ::BIO_new(method.get());
    if (bio) {
        ::BIO_set_data(bio, data);
        ::BIO_set_init(bio, 1);
    }
    return bio;
}

// OpenSSL's own socket BIO reads without limit.

int take(BIO* bio, char* into, std::size_t size, std::size_t* taken)
{
    auto& turn = *static_cast<SocketTurn*>(::BIO_get_data(bio));
    BIO_clear_retry_flags(bio);
    *taken = 0;
    ssize_t bytes = 0;
    if (turn.left > 0)
        do
            bytes = ::recv(turn.socket, into, std::min(size, turn.left), MSG_DONTWAIT);
        while (bytes < 0 && errno == EINTR);
    if (bytes > 0) {
        turn.took(static_cast<std::size_t>(bytes));
        *taken = static_cast<std::size_t>(bytes);
        return 1;
    }
    turn.ended = turn.left > 0 && bytes == 0;
    if (turn.left == 0 || (bytes < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)))
        BIO_set_retry_read(bio);
    return 0;
}

long control_incoming(BIO* bio, int command, long, void*)
{
    return command == BIO_CTRL_EOF && static_cast<const SocketTurn*>(::BIO_get_data(bio))->ended ? 1 : 0;
}

BIO* new_incoming(SocketTurn& turn)
{
    static const MethodPtr method = [] {
        auto made = new_method(BIO_TYPE_SOURCE_SINK, "incoming", control_incoming);
        ::BIO_meth_set_read_ex(made.get(), take);
        return made;
    }();
    return new_bio(method, &turn);
}

void on_message(int sent, int, int type, const void* bytes, std::size_t size, SSL*, void* data)
{
    auto& turn = *static_cast<SocketTurn*>(data);
    if (sent != 0 || type != SSL3_RT_HANDSHAKE || size == 0
        || *static_cast<const unsigned char*>(bytes) != SSL3_MT_KEY_UPDATE)
        return;
    ++turn.key_updates;
    if (turn.flooded())
        turn.left = 0;
}

// OpenSSL's own memory BIO wipes its whole buffer for each message; this one appends to a vector.

int append(BIO* bio, const char* bytes, std::size_t size, std::size_t* written)
try {
    auto& outgoing = *static_cast<std::vector<unsigned char>*>(::BIO_get_data(bio));
    const auto* at = reinterpret_cast<const unsigned char*>(bytes);  // other types would be copied one by one
    outgoing.insert(outgoing.end(), at, at + size);
    *written = size;
    return 1;
} catch (...) {
    return 0;
}

long control_outgoing(BIO*, int command, long, void*) { return command == BIO_CTRL_FLUSH ? 1 : 0; }

BIO* new_outgoing(std::vector<unsigned char>& outgoing)
{
    static const MethodPtr method = [] {
        auto made = new_method(BIO_TYPE_SOURCE_SINK, "outgoing", control_outgoing);
        ::BIO_meth_set_write_ex(made.get(), append);
        return made;
    }();
    return new_bio(method, &outgoing);
}

}  // namespace

SslPtr make_tls_session(TlsEnd end, SocketTurn& turn, KeyTalk& talk, std::vector<unsigned char>& outgoing)
{
    SslPtr session(::SSL_new(context_of(end)), ::SSL_free);
    BIO* in = new_incoming(turn);
    BIO* out = new_outgoing(outgoing);
    if (!session || !in || !out) {
        ::BIO_free(in);
        ::BIO_free(out);
        throw Error(Errc::failed, "no memory for a TLS session");
    }
    ::SSL_set_bio(session.get(), in, out);
    SSL_set_app_data(session.get(), &talk);
    ::SSL_set_msg_callback(session.get(), on_message);
    SSL_set_msg_callback_arg(session.get(), &turn);
    end == TlsEnd::listener ? ::SSL_set_accept_state(session.get()) : ::SSL_set_connect_state(session.get());
    return session;
}

bool proved(const SSL& session, const KeyTalk& talk)
{
    auto* ssl = const_cast<SSL*>(&session);  // OpenSSL's getters are not const
    return talk.shown && ::SSL_is_init_finished(ssl) == 1 && ::SSL_version(ssl) == TLS1_3_VERSION
           && ::SSL_session_reused(ssl) == 1;
}

}  // namespace hive::transport
