// Forwards the public handles of a drone to its core.
#include "drone_core.hpp"

#include <hive/name.hpp>

namespace hive {
namespace {

ParameterInfo describe(const std::string& name, ParameterType type, const Constraint& constraint,
                       const std::string& help)
{
    return {.name = require_name(name, "parameter"),
            .type = type,
            .default_value = {},
            .least = constraint.least,
            .most = constraint.most,
            .choices = constraint.choices,
            .unit = constraint.unit,
            .help = help,
            .for_operator = constraint.for_operator};
}

/// Calls `body` only if a receiver will get it.
std::function<std::optional<Body>()> if_needed(const service::Emitter& emitter, std::size_t output,
                                               const std::function<Body()>& body)
{
    return [&emitter, output, &body] { return emitter.needs_body(output) ? std::optional(body()) : std::nullopt; };
}

}  // namespace

void Drone::parameter(const std::string& name, int& variable, const Constraint& constraint, const std::string& help)
{
    Constraint whole = constraint;  // the range of int
    whole.least = std::max(constraint.least.value_or(-2147483648.0), -2147483648.0);
    whole.most = std::min(constraint.most.value_or(2147483647.0), 2147483647.0);
    core_.declaration().parameters.add(describe(name, ParameterType::integer, whole, help), variable);
}

void Drone::parameter(const std::string& name, double& variable, const Constraint& constraint, const std::string& help)
{
    core_.declaration().parameters.add(describe(name, ParameterType::number, constraint, help), variable);
}

void Drone::parameter(const std::string& name, bool& variable, const Constraint& constraint, const std::string& help)
{
    core_.declaration().parameters.add(describe(name, ParameterType::flag, constraint, help), variable);
}

void Drone::parameter(const std::string& name, std::string& variable, const Constraint& constraint,
                      const std::string& help)
{
    core_.declaration().parameters.add(describe(name, ParameterType::text, constraint, help), variable);
}

Output Drone::output(const std::string& name, const std::string& type, const std::string& help, Encoder encoder)
{
    return {core_, core_.emitter().add_output({require_port_name(name, "output"), type, help}, std::move(encoder))};
}

void Drone::on_event(const std::string& input, const std::string& type, std::function<void(const Event&)> callback,
                     const std::string& help)
{
    core_.declaration().add_input(input, type, std::move(callback), help);
}

Matching Drone::on_matched(const std::vector<MatchedInput>& inputs, Match match,
                           std::function<void(const std::vector<Event>&)> callback)
{
    return {core_, core_.declaration().add_matching(inputs, match, std::move(callback))};
}

void Matching::rule(Match match) const { core_->declaration().matchings[index_].matcher.rule(match); }

std::optional<Json> Drone::given(const std::string& parameter) const { return core_.given(parameter); }
bool Drone::remembered(const std::string& parameter) const { return core_.remembered(parameter); }
void Drone::on_change(std::function<void()> callback) { core_.declaration().on_change = std::move(callback); }
void Drone::on_start(std::function<void()> callback) { core_.declaration().on_start = std::move(callback); }
void Drone::on_end(std::function<void(const std::string&)> callback)
{
    core_.declaration().on_end = std::move(callback);
}
void Drone::main(std::function<std::chrono::microseconds()> step) { core_.declaration().main = std::move(step); }
void Drone::run() { core_.run(); }
void Drone::wake() { core_.wake(); }
void Drone::stop() { core_.stop(); }
void Drone::condition(const std::string& text, Reason why, LogLevel level) { core_.condition(text, why, level); }
void Drone::source_events(std::int64_t events) { core_.source_events(events); }
void Drone::report(Errc code, const std::string& text) { core_.reporter().report(Error(code, text)); }
void Drone::log(const std::string& text, LogLevel level) { core_.reporter().log(level, text); }
Status Drone::status() const { return core_.status(); }
bool Drone::stopping() const { return core_.stopping(); }

Loan Output::loan(std::size_t bytes) const { return core_->emitter().loan(bytes); }

bool Output::wanted() const { return core_->emitter().wanted(index_); }
bool Output::received() const { return core_->emitter().received(index_); }
bool Output::asked() const { return core_->emitter().asked(index_); }
bool Output::backlogged() const { return core_->emitter().backlogged(index_); }

void Output::emit(Json header, Body body, std::string type) const
{
    core_->emitter().emit(
        index_, std::nullopt, std::move(header), [&] { return std::optional(std::move(body)); }, std::move(type));
}

void Output::emit(Json header, const std::function<Body()>& body, std::string type) const
{
    core_->emitter().emit(index_, std::nullopt, std::move(header), if_needed(core_->emitter(), index_, body),
                          std::move(type));
}

void Output::emit_captured(std::chrono::system_clock::time_point captured, bool lossless, Json header,
                           const std::function<Body()>& body, std::string type) const
{
    const auto captured_us = event::microseconds(captured.time_since_epoch());
    core_->emitter().emit(index_, core_->emitter().fresh_identity(index_, captured_us, lossless), std::move(header),
                          if_needed(core_->emitter(), index_, body), std::move(type));
}

void Output::fail(std::chrono::system_clock::time_point captured, bool lossless, Errc code,
                  const std::string& text) const
{
    core_->emitter().fail(index_, event::microseconds(captured.time_since_epoch()), lossless, Error(code, text));
}

void Output::end(const std::string& text) const { core_->emitter().end(index_, text); }
void Output::begin_source() const { core_->emitter().begin_source(index_); }

void Output::repeat(Event event) const { core_->emitter().repeat(index_, std::move(event)); }

}  // namespace hive
