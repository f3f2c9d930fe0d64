// The signals of the system.
#include <hive/platform/signals.hpp>

#include <asio/signal_set.hpp>

#include <csignal>
#include <utility>

namespace hive::platform {

struct Signals::Real {
    asio::signal_set signals;
};

Signals::Signals(asio::io_context& context, std::function<void(int)> handler)
    : real_(new Real{asio::signal_set(context, SIGINT, SIGTERM)})
{
    real_->signals.async_wait([handler = std::move(handler)](std::error_code problem, int number) {
        if (!problem)
            handler(number);
    });
}

Signals::~Signals() = default;

}  // namespace hive::platform
