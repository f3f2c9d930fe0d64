// Reads and writes the state of a drone as JSON.
#include "state_file.hpp"

#include <hive/protocol/requests.hpp>

namespace hive::service {
namespace {

constexpr auto left_at = "left_us";
constexpr std::chrono::minutes returns_within{1};

Json connection_json(const event::IntakeSpec& spec)
{
    return to_json(protocol::Connect{.drone = spec.sender,
                                     .output = spec.output,
                                     .address = to_text(spec.address),
                                     .input = spec.input,
                                     .options = spec.options});
}

Json subscriber_json(const event::Subscriber& subscriber)
{
    Json json{{"output", subscriber.output}, {"receiver", subscriber.receiver}};
    if (!subscriber.group.empty())
        json["group"] = subscriber.group;
    if (subscriber.pid != 0)
        json["pid"] = subscriber.pid;
    if (const auto& [count, source, epoch] = subscriber.missed; count > 0)
        json["missed"] = {{"events", count}, {"source", source}, {"epoch", epoch}};
    if (subscriber.dormant)
        json["dormant"] = true;
    return json;
}

event::Subscription::Missed missed_from(const Fields& subscriber)
{
    if (!subscriber.has("missed"))
        return {};
    const Fields missed(subscriber.object("missed"), "a saved subscriber: missed");
    return {.count = missed.integer("events", 0, max_json_integer),
            .source = missed.text("source"),
            .epoch = missed.integer("epoch", 0, max_json_integer)};
}

/// Peers keep its places for 30 s. An older file was left by a start that failed.
Json left_to_return(const event::Home& home, const std::string& name)
{
    const auto left = home.read_return(name);
    const auto age_us =
        left ? event::wall_us() - Fields(*left, "what it left").integer(left_at, 0, max_json_integer) : 0;
    return left && std::abs(age_us) < event::microseconds(returns_within) ? *left : Json::object();
}

}  // namespace

bool is_to_return(const Json& state) { return state.contains(left_at); }

std::int64_t left_epoch(const Json& state, const Reporter& reporter)
try {
    return Fields(state, "state").integer_or("epoch", 0, max_json_integer / 2, 0);
} catch (const Error& error) {
    reporter.log(LogLevel::warning, std::string("ignored the saved epoch: ") + error.what());
    return 0;
}

std::vector<event::Subscriber> subscribers_from(const Json& state, const Reporter& reporter)
{
    std::vector<event::Subscriber> subscribers;
    for (const auto& saved : state.value("subscribers", Json::array()))
        try {
            const Fields fields(saved, "a saved subscriber");
            subscribers.push_back({.output = fields.text("output"),
                                   .receiver = fields.text("receiver"),
                                   .group = fields.text_or("group", ""),
                                   .pid = fields.integer_or("pid", 0, max_json_integer, 0),
                                   .missed = missed_from(fields),
                                   .dormant = fields.flag_or("dormant", false)});
        } catch (const Error& error) {
            reporter.log(LogLevel::warning, std::string("ignored a saved subscriber: ") + error.what());
        }
    return subscribers;
}

Json left_state(const event::Home& home, const protocol::Hello& self, OtherKind other, const Reporter& reporter)
try {
    const auto state = home.read_state(self.name);
    if (!state)
        return left_to_return(home, self.name);
    if (const auto kind = Fields(*state, "state").text("kind"); kind != self.kind && other == OtherKind::leave_out) {
        reporter.log(LogLevel::warning,
                     "ignored the saved state of a drone of this name and of kind " + in_quotes(kind));
        return Json::object();
    }
    return *state;
} catch (const std::exception& error) {
    reporter.log(LogLevel::warning, std::string("ignored the saved state, which cannot be read: ") + error.what());
    return Json::object();
}

Json still_taken(const Json& saved, const ParameterSet& parameters, const Reporter& reporter)
{
    Json values = Json::object();
    for (const auto& [name, value] : saved.items())
        try {
            values.update(parameters.checked(Json::object({{name, value}})));
        } catch (const Error& error) {
            reporter.log(LogLevel::warning, std::string("ignored a saved value: ") + error.what());
        }
    return values;
}

void StateFile::remember()
{
    if (board_.stopping() && !board_.handing_over())
        return;
    try {
        subscribers_ = module_.subscribers();
        if (returns_) {
            Json left = wired();
            left[left_at] = event::wall_us();
            home_.write_return(module_.self().name, left);
        } else {
            home_.write_state(module_.self().name, state());
        }
        forgetful_ = false;
    } catch (const std::exception& error) {
        if (!std::exchange(forgetful_, true))
            reporter_.report(Error(Errc::io, std::string("cannot save state for crash recovery: ") + error.what()));
    }
}

void StateFile::remember_to_return()
{
    returns_ = true;
    remember();
}

void StateFile::subscribers_changed()
{
    if (module_.subscribers() != subscribers_)
        remember();
}

Json StateFile::wired() const
{
    Json subscribers = Json::array();
    for (const auto& subscriber : subscribers_)
        subscribers.push_back(subscriber_json(subscriber));
    Json connections = Json::array();
    for (const auto& intake : module_.intakes())
        if (auto spec = intake->spec(); !spec.output.empty()) {
            spec.options = intake->confirmed_options();
            connections.push_back(connection_json(spec));
        }
    return {{"epoch", module_.self().epoch}, {"connections", connections}, {"subscribers", subscribers}};
}

Json StateFile::state() const
{
    Json state = listening_.saved();
    state.update(wired());
    state.update({{"kind", declaration_.interface.kind},
                  {"parameters", declaration_.parameters.changed()},
                  {"policy", token(board_.policy())},
                  {"swarm", board_.values().swarm}});
    return state;
}

}  // namespace hive::service
