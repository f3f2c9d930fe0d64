// Accepts peers, and pauses without descriptors.
#include "accept_loop.hpp"

#include "make_connection.hpp"

#include <hive/protocol/defended.hpp>

#include <algorithm>
#include <netinet/in.h>
#include <sys/socket.h>

namespace hive::transport {
namespace {

constexpr std::chrono::milliseconds exhausted_pause{100};
/// A handshake is not evicted before this time.
constexpr std::chrono::milliseconds guest_timeout{250};
constexpr std::chrono::milliseconds waiting_pause{5};
constexpr int accepted_at_once = 64;  // then existing connections are served

/// The origin of a peer: its address, or for IPv6 the network of its host's addresses. With link-local addresses all
/// hosts have the same network.
std::string host_of(const sockaddr_storage& from)
{
    const auto bytes = [](const void* at, std::size_t count) {
        return std::string(static_cast<const char*>(at), count);
    };
    if (from.ss_family == AF_INET)
        return bytes(&reinterpret_cast<const sockaddr_in&>(from).sin_addr, 4);
    if (from.ss_family != AF_INET6)
        return {};
    const auto& address = reinterpret_cast<const sockaddr_in6&>(from).sin6_addr;
    if (IN6_IS_ADDR_V4MAPPED(&address))
        return bytes(&address.s6_addr[12], 4);
    return bytes(&address, IN6_IS_ADDR_LINKLOCAL(&address) ? 16 : 8);
}

}  // namespace

AcceptLoop::AcceptLoop(asio::io_context& context, int family, int descriptor, Welcome welcome,
                       OnConnection on_connection, const Timing& timing)
    : context_(context),
      family_(family),
      listening_(context, descriptor),
      pause_(context),
      welcome_(std::move(welcome)),
      on_connection_(std::move(on_connection)),
      timing_(timing),
      pauses_(defended("accept-pause")),
      by_host_(defended("turns-by-address"))
{
}

void AcceptLoop::start()
{
    admissions_->freed = [self = weak_from_this()] {
        if (const auto loop = self.lock())
            loop->wait();
    };
    wait();
}

void AcceptLoop::stop()
{
    std::error_code ignored;
    listening_.close(ignored);
    pause_.cancel();
    waiting_ = {};
    guests_.clear();
}

void AcceptLoop::wait()
{
    if (busy_ || !may_accept())
        return;
    busy_ = true;
    listening_.async_wait(asio::posix::stream_descriptor::wait_read,
                          [self = shared_from_this()](std::error_code error) {
                              if (!error)
                                  self->accept_waiting();
                          });
}

void AcceptLoop::accept_waiting()
{
    auto outcome = Outcome::accepted;
    for (int i = 0; i < accepted_at_once && outcome == Outcome::accepted; ++i)
        outcome = may_accept() ? accept_one() : Outcome::nobody;
    admit_waiting();
    if (outcome == Outcome::exhausted)
        return pause(pauses_ ? exhausted_pause : std::chrono::milliseconds(0));
    if (!waiting_.empty())
        return pause(waiting_pause);
    busy_ = false;
    wait();
}

/// The others wait in the kernel's queue, which does not show their addresses. Local peers have none, so all of them
/// wait there until a slot is free.
bool AcceptLoop::may_accept() const
{
    return listening_.is_open() && (family_ == AF_UNIX ? waiting_.size() < admissions_->free() : !waiting_.full());
}

/// Unauthenticated peers must not keep key holders out: evicts the oldest handshake of the host with the most
/// handshakes.
bool AcceptLoop::make_room()
{
    const auto patient_since = std::chrono::steady_clock::now() - guest_timeout;
    if (guests_.empty() || guests_.begin()->second.since > patient_since)
        return false;
    std::map<std::string_view, int> from;
    for (const auto& [number, guest] : guests_)
        ++from[guest.host];
    const auto longest = std::ranges::max_element(guests_, {}, [&](const auto& row) { return from[row.second.host]; });
    if (longest->second.since > patient_since)
        return false;
    guests_.erase(longest);
    return !admissions_->full();
}

AcceptLoop::Outcome AcceptLoop::accept_one()
{
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    Descriptor peer(
        ::accept4(listening_.native_handle(), reinterpret_cast<sockaddr*>(&from), &size, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (peer) {
        waiting_.enter({by_host_ ? host_of(from) : std::string(), std::move(peer)});
        return Outcome::accepted;
    }
    if (errno == ECONNABORTED || errno == EINTR || errno == EPROTO)
        return Outcome::accepted;  // that peer is gone, the next one may be fine
    return errno == EAGAIN || errno == EWOULDBLOCK ? Outcome::nobody : Outcome::exhausted;
}

void AcceptLoop::admit_waiting()
{
    while (!waiting_.empty() && (!admissions_->full() || (waiting_.spoken() && make_room())))
        admit(waiting_.next());
}

void AcceptLoop::admit(WaitingRoom::Peer peer)
{
    const auto guest = ++last_guest_;
    try {
        auto handshake = welcome_(adopt_socket(context_, family_, peer.socket.release()),
                                  [self = shared_from_this(), guest,
                                   admission = admissions_->admit()](std::unique_ptr<Stream> stream) mutable {
                                      self->welcomed(guest, std::move(stream), std::move(admission));
                                  });
        if (handshake)
            guests_[guest] = {std::move(peer.host), std::chrono::steady_clock::now(), std::move(handshake)};
    } catch (const Error&) {
        // The peer left during the check, or the system lacks a resource: it is closed, and may reconnect.
    }
}

void AcceptLoop::welcomed(std::uint64_t guest, std::unique_ptr<Stream> stream, std::shared_ptr<void> admission)
{
    if (stream && listening_.is_open())
        on_connection_(make_connection(context_, std::move(stream), timing_, std::move(admission)));
    guests_.erase(guest);
}

// Without descriptors the listening socket stays readable: waiting for it would spin.
void AcceptLoop::pause(std::chrono::milliseconds time)
{
    if (!listening_.is_open())
        return;
    pause_.expires_after(time);
    pause_.async_wait([self = shared_from_this()](std::error_code error) {
        if (!error && !self->waiting_.empty())
            return self->accept_waiting();
        self->busy_ = false;
        if (!error)
            self->wait();
    });
}

}  // namespace hive::transport
