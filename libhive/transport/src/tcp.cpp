// The tcp transport: its listener, its dialer, its socket options.
#include "accept_loop.hpp"
#include "dial_attempt.hpp"
#include "name_lookup.hpp"
#include "schemes.hpp"
#include "tls_handshake.hpp"
#include "unsent_limit.hpp"

#include <hive/protocol/defended.hpp>

#include <asio/ip/tcp.hpp>

#include <netinet/in.h>
#include <netinet/tcp.h>

namespace hive::transport {
namespace {

using Endpoint = asio::ip::tcp::endpoint;

asio::ip::address plain_address(const Endpoint& endpoint)
{
    const auto address = endpoint.address();
    if (address.is_v6() && address.to_v6().is_v4_mapped())
        return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6());
    return address;
}

bool is_loopback(const Endpoint& peer) { return plain_address(peer).is_loopback(); }

void tune(int descriptor, const Endpoint& peer)
{
    set_option(descriptor, IPPROTO_TCP, TCP_NODELAY, 1);
    set_option(descriptor, SOL_SOCKET, SO_KEEPALIVE, 1);
    set_option(descriptor, IPPROTO_TCP, TCP_KEEPIDLE, 1);   // seconds
    set_option(descriptor, IPPROTO_TCP, TCP_KEEPINTVL, 1);  // seconds
    set_option(descriptor, IPPROTO_TCP, TCP_KEEPCNT, 3);
    // Packets should wait in our lanes, where control overtakes and the oldest is dropped, not in the kernel. Across a
    // network the kernel adapts its buffers to bandwidth and delay, so only its unsent bytes are bounded.
    if (!is_loopback(peer)) {
        if (UnsentLimit::wanted())
            set_option(descriptor, IPPROTO_TCP, TCP_NOTSENT_LOWAT, UnsentLimit::most);
        return;
    }
    set_option(descriptor, SOL_SOCKET, SO_SNDBUF, local_socket_buffer);
    set_option(descriptor, SOL_SOCKET, SO_RCVBUF, local_socket_buffer);
}

template <class Function>
Endpoint name_of(Function get_name, int descriptor)
{
    Endpoint endpoint;
    socklen_t size = static_cast<socklen_t>(endpoint.capacity());
    if (get_name(descriptor, reinterpret_cast<sockaddr*>(endpoint.data()), &size) != 0)
        throw Error(Errc::io, "a socket without an address: " + os_text(errno));
    endpoint.resize(size);
    return endpoint;
}

std::string text_of(const Endpoint& endpoint)
{
    const auto host = endpoint.address().to_string();
    return (endpoint.address().is_v6() ? "[" + host + "]" : host) + ":" + std::to_string(endpoint.port());
}

struct Peer {
    std::string text;
    bool local;  ///< it has the address of this end, or a loopback address; may be an undetectable tunnel
};

Peer peer_of(Socket& socket)
{
    const auto here = name_of(::getsockname, socket.native_handle()),
               peer = name_of(::getpeername, socket.native_handle());
    return {text_of(peer), is_loopback(peer) || plain_address(here) == plain_address(peer)};
}

std::unique_ptr<Stream> plain_stream(Socket socket)
{
    const auto peer = peer_of(socket);
    return make_socket_stream(std::move(socket), peer.text, peer.local);
}

/// A listener's check of a new peer.
AcceptLoop::Welcome welcome_by(const Security& security, std::chrono::milliseconds limit)
{
    return [security, limit](Socket socket, const AcceptLoop::Welcomed& welcomed) -> Handshake {
        tune(socket.native_handle(), name_of(::getpeername, socket.native_handle()));
        if (!security.keys) {
            welcomed(plain_stream(std::move(socket)));
            return nullptr;
        }
        const auto peer = peer_of(socket);
        return shake_hands(
            std::move(socket),
            {.end = TlsEnd::listener,
             .keys = security.keys->accepted(),
             .limit = limit,
             .peer = peer.text,
             .local = peer.local},
            [welcomed, refused = security.refused, who = peer.text](Result<std::unique_ptr<Stream>> stream) {
                if (const auto* error = error_of(stream))
                    refused("refused " + who + ": " + error->what());
                welcomed(value_or_none(std::move(stream)));
            });
    };
}

/// The endpoint to listen at. Resolves names synchronously, since a module listens once, before it serves peers.
Endpoint listening_endpoint(asio::io_context& context, const Address& address)
{
    std::error_code error;
    if (const auto number = asio::ip::make_address(address.host, error); !error)
        return {number, address.port};
    const auto found =
        asio::ip::tcp::resolver(context).resolve(address.host, "", asio::ip::resolver_base::passive, error);
    if (error || found.empty())
        throw Error(Errc::invalid_argument, "cannot listen on " + to_text(address) + ": the name is not known");
    return {found.begin()->endpoint().address(), address.port};
}

Error listen_failure(const Address& address, int error)
{
    const auto text = "cannot listen on " + to_text(address) + ": ";
    if (error == EADDRINUSE)
        return {Errc::name_taken, text + "port " + std::to_string(address.port) + " is taken"};
    return {error == EACCES ? Errc::not_permitted : Errc::io, text + os_text(error)};
}

class TcpDial final : public DialAttempt {
public:
    TcpDial(asio::io_context& context, const Address& address, OnDialed on_dialed, const Timing& timing,
            const Security& security)
        : DialAttempt(context, address, std::move(on_dialed), timing), ring_(security.keys)
    {
    }

private:
    void begin() override
    {
        read_keys();
        std::error_code error;
        if (const auto number = asio::ip::make_address(address_.host, error); !error)
            return try_all({Endpoint(number, address_.port)});
        lookup_ = std::make_unique<NameLookup>(
            context_, address_.host, address_.port,
            [weak = weak_from_this()](const NameLookup::Endpoints& found, const std::string& why) {
                if (const auto self = std::static_pointer_cast<TcpDial>(weak.lock()))
                    self->on_found(found, why);
            });
    }
    /// Without a key the dialer connects unencrypted; a listener that requires a key refuses.
    void read_keys()
    {
        try {
            if (ring_)
                keys_ = ring_->own();
        } catch (const Error& error) {
            if (error.code() != Errc::not_found || ring_->required())
                throw;
        }
    }
    void cancel() noexcept override
    {
        lookup_.reset();
        handshake_.reset();
        std::error_code ignored;
        socket_.close(ignored);
    }
    void on_found(const NameLookup::Endpoints& found, const std::string& why)
    {
        if (answered())
            return;
        if (found.empty())
            fail(Errc::unreachable, why);
        else
            try_all(found);
    }
    void try_all(NameLookup::Endpoints endpoints)
    {
        endpoints_ = std::move(endpoints);
        try_next();
    }
    void try_next()
    try {
        const auto& to = endpoints_.at(next_);
        socket_ = open_socket(context_, to.protocol().family());
        tune(socket_.native_handle(), to);
        socket_.async_connect({to.data(), to.size(), IPPROTO_TCP},
                              [self = std::static_pointer_cast<TcpDial>(shared_from_this())](std::error_code error) {
                                  if (!self->answered())
                                      self->on_connected(error);
                              });
    } catch (const Error& error) {
        fail(Errc::unreachable, error.what());
    }
    void on_connected(std::error_code error)
    try {
        // A dial to a free port of this machine may get that port as its own, and connect to itself.
        if (!error
            && name_of(::getsockname, socket_.native_handle()) == name_of(::getpeername, socket_.native_handle()))
            error = asio::error::connection_refused;
        if (error && ++next_ < endpoints_.size())
            try_next();
        else if (error)
            fail(Errc::unreachable, error.message());
        else if (keys_.empty())
            succeed(plain_stream(std::move(socket_)));
        else
            show_key();
    } catch (const Error& lost) {
        fail(Errc::unreachable, lost.what());
    }
    void show_key()
    {
        const auto peer = peer_of(socket_);
        handshake_ = shake_hands(std::move(socket_),
                                 {.end = TlsEnd::dialer,
                                  .keys = {keys_.at(shown_)},
                                  .limit = std::chrono::hours(1),  // the dial has its own deadline
                                  .peer = peer.text,
                                  .local = peer.local},
                                 [this](Result<std::unique_ptr<Stream>> stream) { on_shaken(std::move(stream)); });
    }
    /// A peer that does not know the newest key may know the previous one.
    void on_shaken(Result<std::unique_ptr<Stream>> stream)
    {
        const auto self = shared_from_this();
        const auto* error = error_of(stream);
        if (!error)
            return succeed(value_or_none(std::move(stream)));
        if (error->code() == Errc::not_permitted && ++shown_ < keys_.size())
            return try_next();
        fail(error->code() == Errc::connection_lost ? Errc::unreachable : error->code(), error->what(),
             error->advice());
    }

    std::unique_ptr<NameLookup> lookup_;
    NameLookup::Endpoints endpoints_;
    std::size_t next_ = 0;
    std::shared_ptr<KeyRing> ring_;
    std::vector<SwarmKey> keys_;  ///< to be offered, one after the other
    std::size_t shown_ = 0;
    Handshake handshake_;
    Socket socket_{context_};
};

}  // namespace

std::unique_ptr<Listener> listen_tcp(asio::io_context& context, const Address& address, OnConnection on_connection,
                                     const Timing& timing, const Security& security)
{
    const auto endpoint = listening_endpoint(context, address);
    const int family = endpoint.protocol().family();
    auto socket = open_socket(context, family);
    const int descriptor = socket.native_handle();
    set_option(descriptor, SOL_SOCKET, SO_REUSEADDR, 1);  // allows a port with lingering old connections
    if (!defended("own-port"))
        set_option(descriptor, SOL_SOCKET, SO_REUSEPORT, 1);
    if (::bind(descriptor, reinterpret_cast<const sockaddr*>(endpoint.data()), static_cast<socklen_t>(endpoint.size()))
            != 0
        || ::listen(descriptor, defended("backlog") ? SOMAXCONN : 1) != 0)
        throw listen_failure(address, errno);
    auto bound = address;
    bound.port = name_of(::getsockname, descriptor).port();
    auto loop = std::make_shared<AcceptLoop>(
        context, family, socket.release(), welcome_by(security, timing.first_packet), std::move(on_connection), timing);
    return std::make_unique<SocketListener>(std::move(loop), std::move(bound));
}

bool is_of_this_machine(const Address& address)
{
    std::error_code error;
    const auto number = asio::ip::make_address(address.host, error);
    if (error)
        return true;
    const Endpoint any_port(number, 0);
    const int socket = ::socket(any_port.protocol().family(), SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (socket < 0)
        return errno != EAFNOSUPPORT;
    const bool has =
        ::bind(socket, reinterpret_cast<const sockaddr*>(any_port.data()), static_cast<socklen_t>(any_port.size())) == 0
        || errno != EADDRNOTAVAIL;
    ::close(socket);
    return has;
}

void dial_tcp(asio::io_context& context, const Address& address, Milliseconds deadline, OnDialed on_dialed,
              const Timing& timing, const Security& security)
{
    std::make_shared<TcpDial>(context, address, std::move(on_dialed), timing, security)->start(deadline);
}

}  // namespace hive::transport
