// Stores the declarations of a drone's author.
#include "declaration.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hive::service {

const MatchedInput* MatchedInputs::input(const std::string& name) const
{
    const auto found = std::ranges::find(inputs, name, &MatchedInput::name);
    return found == inputs.end() ? nullptr : &*found;
}

Declaration::Declaration(DroneProgram program)
{
    interface.kind = std::move(program.kind);
    interface.summary = std::move(program.summary);
    interface.version = HIVE_VERSION;
    interface.stateful = program.stateful;
}

void Declaration::add_input(const std::string& name, const std::string& type,
                            std::function<void(const Event&)> callback, const std::string& help)
{
    interface.inputs.push_back({require_port_name(name, "input"), type, help});
    callbacks[name] = std::move(callback);
}

std::size_t Declaration::add_matching(const std::vector<MatchedInput>& inputs, Match match,
                                      std::function<void(const Set&)> callback)
{
    std::vector<std::string> names;
    for (const auto& input : inputs) {
        interface.inputs.push_back({require_port_name(input.name, "input"), input.type, input.help});
        names.push_back(input.name);
    }
    interface.stateful = true;
    matchings.push_back({inputs, event::Matcher(names, match), std::move(callback)});
    return matchings.size() - 1;
}

}  // namespace hive::service
