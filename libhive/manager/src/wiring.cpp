// Connecting: which ports fit, and telling the receiver.
#include "application_core.hpp"

#include <hive/name.hpp>

namespace hive {

using protocol::PacketType;

namespace {

using Pair = std::pair<const Port*, const Port*>;

std::vector<const Port*> candidates(const std::vector<Port>& ports, const Endpoint& end, const char* what)
{
    std::vector<const Port*> found;
    std::vector<std::string> names;
    for (const auto& port : ports) {
        names.push_back(port.name);
        if (end.port.empty() || port.name == end.port)
            found.push_back(&port);
    }
    if (found.empty()) {
        const auto near = nearest(end.port, names);
        throw Error(Errc::not_found, end.drone + " has no " + what + (end.port.empty() ? "" : " " + end.port)
                                         + (near.empty() ? "" : "; did you mean " + near + "?"));
    }
    return found;
}

std::string listed(const Endpoint& sender, const Endpoint& receiver, const std::vector<Pair>& pairs)
{
    std::string text;
    for (const auto& [output, input] : pairs)
        text += (text.empty() ? "" : ", or ") + sender.drone + "." + output->name + " " + receiver.drone + "."
                + input->name;
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
        throw Error(Errc::invalid_argument, "several ports fit; name them: " + listed(sender, receiver, pairs));
    if (outputs.size() == 1 && inputs.size() == 1)
        throw Error(Errc::type_mismatch, sender.drone + "." + outputs[0]->name + " is " + outputs[0]->type + ", but "
                                             + receiver.drone + "." + inputs[0]->name + " takes " + inputs[0]->type);
    std::string types;
    for (const auto* output : outputs)
        types += " " + output->name + " (" + output->type + ")";
    types += "; inputs of " + receiver.drone + ":";
    for (const auto* input : inputs)
        types += " " + input->name + " (" + input->type + ")";
    throw Error(Errc::type_mismatch, "nothing fits: outputs of " + sender.drone + ":" + types);
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

void Application::disconnect(const Endpoint& sender, const Endpoint& receiver)
{
    Json header{{"from", {{"drone", sender.drone}}}};
    if (!sender.port.empty())
        header["from"]["output"] = sender.port;
    if (!receiver.port.empty())
        header["input"] = receiver.port;
    core_->ask(receiver.drone, PacketType::disconnect, header);
}

}  // namespace hive
