// What a drone was told: kept beside its socket, and taken again after a crash.
#include "drone_core.hpp"

namespace hive {
namespace {

Json spec_json(const event::IntakeSpec& spec)
{
    return to_json(protocol::Connect{.drone = spec.sender,
                                     .output = spec.output,
                                     .address = to_text(spec.address),
                                     .input = spec.input,
                                     .options = spec.options});
}

}  // namespace

/// What a crashed drone of this name and kind was told; an empty object when there is nothing of use.
Json DroneCore::left_state(const event::Home& home) const
try {
    const auto state = home.read_state(settings_.name);
    if (!state)
        return Json::object();
    if (const auto kind = Fields(*state, "state").text("kind"); kind != interface.kind) {
        log("what was told to a drone of this name and of the kind " + in_quotes(kind) + " is left out");
        return Json::object();
    }
    return *state;
} catch (const std::exception& error) {
    log(std::string("what a drone of this name was told cannot be read and is left out: ") + error.what());
    return Json::object();
}

/// The saved values that this drone still takes.
Json DroneCore::still_taken(const Json& saved) const
{
    Json values = Json::object();
    for (const auto& [name, value] : saved.items())
        try {
            values.update(parameters.checked(Json::object({{name, value}})));
        } catch (const Error& error) {
            log(std::string("a saved value is left out: ") + error.what());
        }
    return values;
}

void DroneCore::restore(const Json& state)
{
    for (const auto& saved : state.value("connections", Json::array()))
        try {
            add_intake(intake_spec(protocol::connect_from_json(saved)))->start({});
        } catch (const Error& error) {
            log(std::string("a saved connection is left out: ") + error.what());
        }
}

Json DroneCore::state() const
{
    Json connections = Json::array();
    for (const auto& intake : module_->intakes())
        if (!intake->spec().output.empty())
            connections.push_back(spec_json(intake->spec()));
    std::string_view policy;
    {
        const std::lock_guard lock(board_mutex_);
        policy = token(board_.policy);
    }
    return {{"kind", interface.kind},
            {"parameters", parameters.changed()},
            {"connections", connections},
            {"policy", policy}};
}

/// A drone that cannot write its state goes on without, and says so once.
void DroneCore::remember()
{
    if (stopping_)
        return;
    try {
        home_->write_state(settings_.name, state());
        forgetful_ = false;
    } catch (const std::exception& error) {
        if (!std::exchange(forgetful_, true))
            report(Errc::io, std::string("what this drone is told would not outlive a crash: ") + error.what(),
                   nullptr);
    }
}

}  // namespace hive
