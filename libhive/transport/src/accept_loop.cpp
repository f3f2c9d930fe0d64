// Accepting.
#include "accept_loop.hpp"

#include "make_connection.hpp"

#include <sys/socket.h>

namespace hive::transport {
namespace {

constexpr std::chrono::milliseconds exhausted_pause{100};
/// Of the peers that shake hands, and fill the hall: nobody has to go for another one before that.
constexpr std::chrono::milliseconds guest_patience{250};
constexpr int accepted_at_once = 16;  // then the connections that exist have their turn

}  // namespace

AcceptLoop::AcceptLoop(asio::io_context& context, int family, int descriptor, Welcome welcome,
                       OnConnection on_connection, const Timing& timing)
    : context_(context),
      family_(family),
      listening_(context, descriptor),
      pause_(context),
      welcome_(std::move(welcome)),
      on_connection_(std::move(on_connection)),
      timing_(timing)
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
    guests_.clear();
}

void AcceptLoop::wait()
{
    if (busy_ || !listening_.is_open() || (admissions_->full() && guests_.empty()))
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
        outcome = listening_.is_open() && make_room() ? accept_one() : Outcome::nobody;
    if (outcome == Outcome::exhausted)
        return pause(exhausted_pause);
    if (admissions_->full() && !guests_.empty())
        return pause(guest_patience / 10);
    busy_ = false;
    wait();
}

/// Strangers who hold places and prove nothing do not keep out those who would: whoever has been here for longest goes.
bool AcceptLoop::make_room()
{
    if (!admissions_->full())
        return true;
    const auto longest = guests_.begin();
    if (longest == guests_.end() || std::chrono::steady_clock::now() < longest->second.since + guest_patience)
        return false;
    guests_.erase(longest);
    return !admissions_->full();
}

AcceptLoop::Outcome AcceptLoop::accept_one()
{
    const int descriptor = ::accept4(listening_.native_handle(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (descriptor >= 0) {
        admit(descriptor);
        return Outcome::accepted;
    }
    if (errno == ECONNABORTED || errno == EINTR || errno == EPROTO)
        return Outcome::accepted;  // that peer is gone, the next one may be fine
    return errno == EAGAIN || errno == EWOULDBLOCK ? Outcome::nobody : Outcome::exhausted;
}

void AcceptLoop::admit(int descriptor)
{
    const auto guest = ++last_guest_;
    try {
        auto handshake = welcome_(adopt_socket(context_, family_, descriptor),
                                  [self = shared_from_this(), guest,
                                   admission = admissions_->admit()](std::unique_ptr<Stream> stream) mutable {
                                      self->welcomed(guest, std::move(stream), std::move(admission));
                                  });
        if (handshake)
            guests_[guest] = {std::chrono::steady_clock::now(), std::move(handshake)};
    } catch (const Error&) {
        // The peer went away while it was looked at, or the system is short of something: it is closed, it may come
        // again.
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
        self->busy_ = false;
        if (!error)
            self->wait();
    });
}

}  // namespace hive::transport
