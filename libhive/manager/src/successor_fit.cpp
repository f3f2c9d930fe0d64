// Compares the used part of one interface with another.
#include "successor_fit.hpp"

#include <hive/name.hpp>

#include <optional>

namespace hive {
namespace {

/// The type of a port at the other end, if that is a drone and answers.
std::optional<std::string> type_at(Application& application, const Endpoint& end,
                                   const Port* (Interface::*port)(std::string_view) const)
try {
    const auto interface = application.describe(end.drone);
    const Port* found = (interface.*port)(end.port);
    return found ? std::optional(found->type) : std::nullopt;
} catch (const Error&) {
    return std::nullopt;  // not running, or an application
}

[[noreturn]] void refuse_missing(const Interface& next, const std::string& what, const std::string& why)
{
    throw Error(Errc::refused, next.kind + " has no " + what + ", " + why);
}

void require_input(Application& application, const Predecessor& before, const Interface& next, const InputStatus& row)
{
    const Port* input = next.input(row.input);
    if (!input)
        refuse_missing(next, "input " + row.input, "which receives " + row.from);
    if (next.stateful && !row.options.group.empty())
        throw Error(Errc::refused, next.kind + " keeps state between events, so it cannot share " + row.from);
    const Port* same = before.interface.input(row.input);
    if (same && same->type == input->type)
        return;
    const auto comes = type_at(application, application.endpoint(row.from), &Interface::output);
    const std::string type = comes ? *comes : same ? same->type : "*/*";
    if (!types_fit(type, input->type))
        throw Error(Errc::type_mismatch, row.from + " is " + type + ", but input " + row.input + " of " + next.kind
                                             + " takes " + input->type);
}

void require_output(Application& application, const Predecessor& before, const Interface& next, const std::string& name,
                    const EdgeStatus& edge)
{
    const Port* same = before.interface.output(name);
    if (!same || edge.group || !edge.connected)
        return;  // every drone has the output of exceptions
    const Port* output = next.output(name);
    if (!output)
        refuse_missing(next, "output " + name, "which " + edge.receiver + " receives");
    if (output->type == same->type)
        return;
    const auto taken = type_at(application, application.endpoint(edge.receiver), &Interface::input);
    if (!types_fit(output->type, taken.value_or(same->type)))
        throw Error(Errc::type_mismatch, "output " + name + " of " + next.kind + " is " + output->type + ", but "
                                             + edge.receiver + " takes " + taken.value_or(same->type));
}

void require_parameters(const Json& told, const Interface& next)
{
    for (const auto& [name, value] : told.items()) {
        const auto* parameter = next.parameter(name);
        if (!parameter)
            refuse_missing(next, "parameter " + name, "which was set to " + value.dump());
        (void)checked_value(*parameter, value);
    }
}

}  // namespace

void require_fit(Application& application, const Predecessor& before, const Interface& next)
{
    for (const auto& row : before.status.inputs)
        if (!row.from.empty())
            require_input(application, before, next, row);
    for (const auto& output : before.status.outputs)
        for (const auto& edge : output.edges)
            require_output(application, before, next, output.name, edge);
    require_parameters(before.parameters, next);
}

}  // namespace hive
