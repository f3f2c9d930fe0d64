// Finds the pair of ports by their types.
#include "match_ports.hpp"

namespace hive {
namespace {

std::vector<const Port*> ports_of(const std::vector<Port>& ports, const Endpoint& end, const char* what)
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

std::string listed_pairs(const Endpoint& sender, const Endpoint& receiver, const std::vector<PortPair>& pairs)
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

}  // namespace

std::vector<PortPair> matching_ports(const Endpoint& sender, const Interface& from, const Endpoint& receiver,
                                     const Interface& to)
{
    std::vector<PortPair> pairs;
    for (const auto* output : ports_of(from.outputs, sender, "output"))
        for (const auto* input : ports_of(to.inputs, receiver, "input"))
            if (types_fit(output->type, input->type))
                pairs.emplace_back(output, input);
    return pairs;
}

PortPair match_ports(const Endpoint& sender, const Interface& from, const Endpoint& receiver, const Interface& to)
{
    const auto pairs = matching_ports(sender, from, receiver, to);
    if (pairs.size() == 1)
        return pairs.front();
    if (pairs.size() > 1)
        throw Error(Errc::invalid_argument,
                    "several outputs of " + sender.drone + " and inputs of " + receiver.drone + " fit",
                    "say which: " + listed_pairs(sender, receiver, pairs));
    const auto outputs = ports_of(from.outputs, sender, "output"), inputs = ports_of(to.inputs, receiver, "input");
    if (outputs.size() == 1 && inputs.size() == 1)
        throw Error(Errc::type_mismatch, sender.drone + "." + outputs[0]->name + " is " + outputs[0]->type + ", but "
                                             + receiver.drone + "." + inputs[0]->name + " takes " + inputs[0]->type);
    throw Error(Errc::type_mismatch, "no output of " + sender.drone + " (" + types_of(outputs) + ") fits an input of "
                                         + receiver.drone + " (" + types_of(inputs) + ")");
}

Error sharing_refused(const std::string& drone)
{
    return {Errc::refused, drone + " keeps state between events, so it must see every one: it cannot share"};
}

}  // namespace hive
