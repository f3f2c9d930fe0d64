// A module that only asks.
#include "caller.hpp"

#include <hive/event/module.hpp>

#include <future>
#include <unistd.h>

namespace hive::bench {

class Caller::Module : public event::Module {
public:
    Module()
        : event::Module(
            {.self = {.name = "bench-caller", .kind = "application", .epoch = event::wall_us(), .pid = ::getpid()},
             .limits = {},
             .timing = {},
             .keys = default_key_file().empty() ? nullptr : std::make_shared<transport::KeyRing>(default_key_file())})
    {
        start();
    }
};

Caller::Caller() : module_(std::make_unique<Module>()) {}
Caller::~Caller() = default;

Json Caller::ask(const std::string& address, protocol::PacketType type, const Json& header)
{
    const auto promise = std::make_shared<std::promise<event::Outcome>>();
    module_->post([this, where = transport::parse_address(address), type, header, promise] {
        const auto deadline = event::Clock::now() + std::chrono::seconds(5);
        module_->request(where, type, header, {}, deadline,
                         [promise](const event::Outcome& outcome) { promise->set_value(outcome); });
    });
    const auto outcome = promise->get_future().get();
    if (const auto* error = std::get_if<Error>(&outcome))
        throw *error;
    return std::get<Json>(outcome);
}

}  // namespace hive::bench
