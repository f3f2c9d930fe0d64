// The answer of a dialer.
#include "dial_attempt.hpp"

#include "liveness.hpp"
#include "make_connection.hpp"

#include <asio/post.hpp>

namespace hive::transport {

DialAttempt::DialAttempt(asio::io_context& context, const Address& address, OnDialed on_dialed, const Timing& timing)
    : context_(context), address_(address), on_dialed_(std::move(on_dialed)), timing_(timing), deadline_(context)
{
}

void DialAttempt::start(std::chrono::milliseconds deadline)
{
    deadline_.run_after(deadline, [self = shared_from_this(), deadline] {
        self->fail(Errc::timeout, "no answer within " + duration_text(deadline));
    });
    try {
        begin();
    } catch (const Error& error) {
        fail(error.code(), error.what(), error.advice());
    }
}

void DialAttempt::succeed(std::unique_ptr<Stream> stream)
{
    if (!answered())
        answer(make_connection(context_, std::move(stream), timing_, nullptr));
}

void DialAttempt::fail(Errc code, const std::string& why, const std::string& advice)
{
    if (!answered())
        answer(Error(code, "cannot reach " + to_text(address_) + ": " + why, advice));
}

void DialAttempt::answer(Result<std::shared_ptr<Connection>> result)
{
    deadline_.cancel();
    cancel();
    asio::post(context_, [told = std::exchange(on_dialed_, nullptr), result = std::move(result)]() mutable {
        told(std::move(result));
    });
}

}  // namespace hive::transport
