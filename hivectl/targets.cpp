// Expanding globs and inferring ports.
#include "targets.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hivectl {
namespace {

std::string listed(const std::vector<hive::Port>& ports)
{
    std::string text;
    for (const auto& port : ports)
        text += (text.empty() ? "" : ", ") + port.name + " (" + port.type + ")";
    return text.empty() ? "none" : text;
}

template <class Fits>
std::vector<std::string> names_of(const std::vector<hive::Port>& ports, Fits fits)
{
    std::vector<std::string> names;
    for (const auto& port : ports)
        if (fits(port))
            names.push_back(port.name);
    return names;
}

/// "face-*.image": the part behind the last dot may be a port or belong to the name; what fits a drone as a whole wins.
std::vector<hive::Endpoint> matching(hive::Application& application, const std::string& pattern)
{
    const auto running = application.drones();
    const auto all_like = [&](std::string_view glob, const std::string& port) {
        std::vector<hive::Endpoint> found;
        for (const auto& drone : running)
            if (hive::matches_glob(glob, drone))
                found.push_back({drone, port});
        return found;
    };
    auto found = all_like(pattern, "");
    const auto dot = pattern.rfind('.');
    if (found.empty() && dot != std::string::npos)
        found = all_like(std::string_view(pattern).substr(0, dot), pattern.substr(dot + 1));
    if (found.empty())
        throw hive::Error(hive::Errc::not_found, "no running drone is called like " + hive::in_quotes(pattern));
    return found;
}

}  // namespace

bool is_glob(std::string_view text) { return text.find_first_of("*?") != std::string_view::npos; }

bool runs(hive::Application& application, const std::string& name)
{
    try {
        application.find(name);
        return true;
    } catch (const hive::Error& error) {
        if (error.code() != hive::Errc::not_found)
            throw;
        return false;
    }
}

std::string to_text(const hive::Endpoint& endpoint)
{
    return endpoint.port.empty() ? endpoint.drone : endpoint.drone + "." + endpoint.port;
}

void add_new(std::vector<std::string>& names, std::vector<std::string> more)
{
    for (auto& name : more)
        if (std::ranges::find(names, name) == names.end())
            names.push_back(std::move(name));
}

std::vector<std::string> drones_named(hive::Application& application, const std::vector<std::string>& words)
{
    std::vector<std::string> names;
    for (const auto& word : words)
        add_new(names, application.find(word));
    return names;
}

std::vector<std::string> drones_named(hive::Application& application, const std::vector<std::string>& words,
                                      Outcome& outcome)
{
    std::vector<std::string> names;
    for (const auto& word : words)
        try {
            add_new(names, application.find(word));
        } catch (const hive::Error& error) {
            outcome.failed(word, error);
        }
    return names;
}

std::vector<hive::Endpoint> endpoints_named(hive::Application& application, const std::vector<std::string>& words)
{
    std::vector<hive::Endpoint> endpoints;
    for (const auto& word : words)
        for (auto& end : is_glob(word) ? matching(application, word) : std::vector{application.endpoint(word)})
            if (std::ranges::find(endpoints, to_text(end), to_text) == endpoints.end())
                endpoints.push_back(std::move(end));
    return endpoints;
}

std::string usual_output(const hive::Interface& interface, const std::string& drone, std::string_view preferred)
{
    const auto best = names_of(interface.outputs,
                               [&](const hive::Port& port) { return port.type.find(preferred) != std::string::npos; });
    if (best.size() == 1)
        return best.front();
    if (interface.outputs.size() == 1)
        return interface.outputs.front().name;
    throw hive::Error(hive::Errc::not_found, interface.outputs.empty()
                                                 ? drone + " has no outputs; see its ports: hivectl describe " + drone
                                                 : drone + " has no output that goes without saying; say which, as "
                                                       + drone + ".OUTPUT: " + listed(interface.outputs));
}

std::vector<hive::Endpoint> outputs_named(hive::Application& application, const std::vector<std::string>& words,
                                          std::string_view preferred)
{
    auto outputs = endpoints_named(application, words);
    for (auto& output : outputs)
        if (output.port.empty())
            output.port = usual_output(application.describe(output.drone), output.drone, preferred);
    return outputs;
}

std::string usual_input(const hive::Interface& interface, const std::string& drone, std::string_view type)
{
    const auto fitting =
        names_of(interface.inputs, [&](const hive::Port& port) { return hive::types_fit(type, port.type); });
    if (fitting.size() == 1)
        return fitting.front();
    if (fitting.empty())
        throw hive::Error(hive::Errc::type_mismatch, drone + " has no input that takes " + std::string(type)
                                                         + "; its inputs: " + listed(interface.inputs));
    throw hive::Error(hive::Errc::not_found, "several inputs of " + drone + " take " + std::string(type)
                                                 + "; say which, as " + drone + ".INPUT: " + listed(interface.inputs));
}

}  // namespace hivectl
