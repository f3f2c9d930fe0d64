// Accepting.
#include "accept_loop.hpp"

#include "make_connection.hpp"

#include <sys/socket.h>

namespace hive::transport {
namespace {

constexpr std::chrono::milliseconds exhausted_pause{100};
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
}

void AcceptLoop::wait()
{
    if (busy_ || !listening_.is_open() || admissions_->full())
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
        outcome = listening_.is_open() && !admissions_->full() ? accept_one() : Outcome::nobody;
    if (outcome == Outcome::exhausted)
        return pause();
    busy_ = false;
    wait();
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
    std::shared_ptr<Connection> connection;
    try {
        if (auto stream = welcome_(adopt_socket(context_, family_, descriptor)))
            connection = make_connection(context_, std::move(stream), timing_, admissions_->admit());
    } catch (const Error&) {
        // The peer went away while it was looked at, or the system is short of something: it is closed, it may come
        // again.
    }
    if (connection)
        on_connection_(std::move(connection));
}

// Without descriptors the listening socket stays readable: waiting for it would spin.
void AcceptLoop::pause()
{
    if (!listening_.is_open())
        return;
    pause_.expires_after(exhausted_pause);
    pause_.async_wait([self = shared_from_this()](std::error_code error) {
        self->busy_ = false;
        if (!error)
            self->wait();
    });
}

}  // namespace hive::transport
