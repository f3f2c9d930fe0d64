// Connecting: which ports fit, and telling the receiver.
#include "application_core.hpp"

#include <hive/name.hpp>
#include <hive/protocol/requests.hpp>

namespace hive {

using protocol::PacketType;

namespace {

using Pair = std::pair<const Port*, const Port*>;

std::vector<const Port*> candidates(const std::vector<Port>& ports, const Endpoint& end, const char* what)
{
    if (!end.port.empty())
        return {&port_named(ports, end.drone, what, end.port)};
    if (ports.empty())
        throw Error(Errc::not_found, end.drone + " has no " + what, "see its ports: hivectl describe " + end.drone);
    std::vector<const Port*> all;
    for (const auto& port : ports)
        all.push_back(&port);
    return all;
}

std::string listed(const Endpoint& sender, const Endpoint& receiver, const std::vector<Pair>& pairs)
{
    std::string text;
    for (const auto& [output, input] : pairs)
        text += (text.empty() ? "" : ", or ") + sender.drone + "." + output->name + " " + receiver.drone + "."
                + input->name;
    return text;
}

std::string types_of(const std::vector<const Port*>& ports)
{
    std::string text;
    for (const auto* port : ports)
        text += (text.empty() ? "" : ", ") + port->name + ": " + port->type;
    return text;
}

/// The one pair of ports that fits.
Pair fitting_pair(const Endpoint& sender, const Interface& from, const Endpoint& receiver, const Interface& to)
{
    const auto outputs = candidates(from.outputs, sender, "output"), inputs = candidates(to.inputs, receiver, "input");
    std::vector<Pair> pairs;
    for (const auto* output : outputs)
        for (const auto* input : inputs)
            if (types_fit(output->type, input->type))
                pairs.emplace_back(output, input);
    if (pairs.size() == 1)
        return pairs.front();
    if (pairs.size() > 1)
        throw Error(Errc::invalid_argument,
                    "several outputs of " + sender.drone + " and inputs of " + receiver.drone + " fit",
                    "say which: " + listed(sender, receiver, pairs));
    if (outputs.size() == 1 && inputs.size() == 1)
        throw Error(Errc::type_mismatch, sender.drone + "." + outputs[0]->name + " is " + outputs[0]->type + ", but "
                                             + receiver.drone + "." + inputs[0]->name + " takes " + inputs[0]->type);
    throw Error(Errc::type_mismatch, "no output of " + sender.drone + " (" + types_of(outputs) + ") fits an input of "
                                         + receiver.drone + " (" + types_of(inputs) + ")");
}

}  // namespace

std::pair<Endpoint, Endpoint> Application::connect(const Endpoint& sender, const Endpoint& receiver,
                                                   const ConnectionOptions& options)
{
    const auto from = describe(sender.drone), to = describe(receiver.drone);
    const auto [output, input] = fitting_pair(sender, from, receiver, to);
    if (to.stateful && !options.group.empty())
        throw Error(Errc::refused,
                    receiver.drone + " keeps state between events, so it must see every one: it cannot share");
    core_->ask(receiver.drone, PacketType::connect,
               {{"from", {{"drone", sender.drone}, {"output", output->name}}},
                {"input", input->name},
                {"options", to_json(options)}});
    return {{sender.drone, output->name}, {receiver.drone, input->name}};
}

void Application::Core::forget(const Endpoint& sender, const Endpoint& receiver)
{
    require_name(receiver.drone, "drone");
    const std::string name = receiver.drone + (receiver.port.empty() ? "" : "." + receiver.port);
    try {
        ask(sender.drone, PacketType::forget, to_json(protocol::Forget{.output = sender.port, .receiver = name}));
    } catch (const Error& error) {
        if (error.code() != Errc::not_found)
            throw;
        throw not_running(receiver.drone).reworded(receiver.drone + " is not running, and " + error.what());
    }
}

void Application::disconnect(const Endpoint& sender, const Endpoint& receiver)
{
    if (!is_name(receiver.drone) || !core_->home.alive(receiver.drone))
        return core_->forget(sender, receiver);
    Json header{{"from", {{"drone", sender.drone}}}};
    if (!sender.port.empty())
        header["from"]["output"] = sender.port;
    if (!receiver.port.empty())
        header["input"] = receiver.port;
    core_->ask(receiver.drone, PacketType::disconnect, header);
}

}  // namespace hive
