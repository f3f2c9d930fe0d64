// Resolves a port of a drone, by its name or as the only match, and checks the encoding of an output.
#include <hive/error.hpp>
#include <hive/interface.hpp>
#include <hive/name.hpp>
#include <hive/transfer.hpp>

#include <algorithm>

namespace hive {
namespace {

std::string listed(const std::vector<const Port*>& ports)
{
    std::string text;
    for (const auto* port : ports)
        text += (text.empty() ? "" : ", ") + port->name + " (" + port->type + ")";
    return text;
}

}  // namespace

const Port& port_named(const std::vector<Port>& ports, const std::string& drone, std::string_view what,
                       std::string_view name)
{
    const auto found = std::ranges::find(ports, name, &Port::name);
    if (found != ports.end())
        return *found;
    std::vector<std::string> names;
    std::ranges::transform(ports, std::back_inserter(names), &Port::name);
    throw no_such(drone + " has no " + std::string(what) + " " + std::string(name), name, names,
                  "see its ports: hivectl describe " + drone);
}

const Port& port_meant(const std::vector<Port>& ports, const std::string& drone, std::string_view what,
                       std::string_view which, const std::function<bool(const Port&)>& fits)
{
    const std::string kind(what), description = which.empty() ? "" : " " + std::string(which);
    std::vector<const Port*> all, fitting;
    for (const auto& port : ports) {
        all.push_back(&port);
        if (fits(port))
            fitting.push_back(&port);
    }
    if (fitting.size() == 1)
        return *fitting.front();
    if (all.empty())
        throw Error(Errc::not_found, drone + " has no " + kind, "see its ports: hivectl describe " + drone);
    if (fitting.empty())
        throw Error(Errc::type_mismatch, drone + " has no " + kind + description, "it has: " + listed(all));
    throw Error(Errc::invalid_argument, drone + " has several " + kind + "s" + description,
                "say which, as " + drone + "." + fitting.front()->name + "; there are: " + listed(fitting));
}

void require_encoding(const Port& output, const std::string& encoding, const std::string& receiver,
                      const std::string& accepts)
{
    if (output.encodings.empty())
        throw Error(Errc::invalid_argument, "output " + output.name + " has no encodings; its events are sent as is");
    if (const auto& type = encoding_named(output.encodings, encoding).type; !types_fit(type, accepts))
        throw Error(Errc::type_mismatch, "output " + output.name + " as " + encoding + " is " + type + ", but "
                                             + receiver + " takes " + accepts);
}

}  // namespace hive
