// Holds the core of a drone for a program.
#include "command_line.hpp"

#include <hive/embedded_drone.hpp>
#include <hive/name.hpp>

#include <algorithm>

namespace hive {
namespace {

DroneSettings settings_of(const DroneProgram& program, EmbeddedOptions options)
{
    DroneSettings settings;
    settings.name = require_name(options.name.empty() ? program.kind : options.name, "drone");
    settings.listen = {std::move(options.listen), std::move(options.advertise), options.insecure, options.key.string(),
                       options.no_announce};
    service::require_sound(settings.listen);
    settings.order.halted = options.halted;
    settings.order.remote_operator = options.remote_operator;
    settings.parameters = std::move(options.parameters);
    settings.connections = service::parse_connects(options.connect);
    if (options.policy)
        settings.order.on_exception = token(*options.policy);
    settings.signals = options.signals;
    settings.ends_process = options.ends_process;
    settings.log = options.log ? std::move(options.log) : [](LogLevel, const std::string&) {};
    return settings;
}

}  // namespace

struct EmbeddedDrone::Parts {
    Parts(const DroneProgram& program, DroneSettings settings) : core(program, std::move(settings)), drone(core) {}

    DroneCore core;
    Drone drone;
    bool started = false;
};

EmbeddedDrone::EmbeddedDrone(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
EmbeddedDrone::EmbeddedDrone(DroneProgram program, EmbeddedOptions options)
    : parts_(std::make_unique<Parts>(program, settings_of(program, std::move(options))))
{
}
EmbeddedDrone::~EmbeddedDrone() = default;

std::unique_ptr<EmbeddedDrone> EmbeddedDrone::from_command_line(int argc, const char* const* argv,
                                                                const DroneProgram& program, int& exit_code)
{
    auto settings = service::read_command_line(argc, argv, program, exit_code);
    if (!settings)
        return nullptr;
    return std::unique_ptr<EmbeddedDrone>(new EmbeddedDrone(std::make_unique<Parts>(program, std::move(*settings))));
}

Drone& EmbeddedDrone::drone() noexcept { return parts_->drone; }
const std::string& EmbeddedDrone::name() const noexcept { return parts_->core.settings().name; }
Interface EmbeddedDrone::interface() const { return parts_->core.interface(); }
void EmbeddedDrone::run() { parts_->core.run(); }

void EmbeddedDrone::start()
{
    parts_->core.start();
    parts_->started = true;
}

bool EmbeddedDrone::step(std::chrono::milliseconds time)
{
    if (!parts_->started)
        throw Error(Errc::invalid_argument, "a drone is started before it works");
    return parts_->core.work(
        std::clamp<std::chrono::milliseconds>(time, std::chrono::milliseconds(1), std::chrono::hours(24)));
}

void EmbeddedDrone::end()
{
    if (parts_->started)
        parts_->core.finish();
}

}  // namespace hive
