// Expands globs and infers ports.
#include "words/targets.hpp"

#include "words/status_line.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hivectl {
namespace {

void add_new(std::vector<hive::Endpoint>& endpoints, std::vector<hive::Endpoint> more)
{
    for (auto& end : more)
        if (std::ranges::find(endpoints, end) == endpoints.end())
            endpoints.push_back(std::move(end));
}

/// "face-*.image": the part after the last dot may be a port or belong to the name; a match of a whole drone name wins.
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
    if (const auto end = hive::parse_endpoint(pattern); found.empty() && !end.port.empty())
        found = all_like(end.drone, end.port);
    if (found.empty())
        throw hive::Error(hive::Errc::not_found, "no drone matches " + hive::in_quotes(pattern),
                          "see what runs: hivectl ps");
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

std::vector<std::string> texts_of(const std::vector<hive::Endpoint>& endpoints)
{
    std::vector<std::string> texts;
    for (const auto& end : endpoints)
        texts.push_back(to_text(end));
    return texts;
}

void add_new(std::vector<std::string>& names, std::vector<std::string> more)
{
    for (auto& name : more)
        if (std::ranges::find(names, name) == names.end())
            names.push_back(std::move(name));
}

std::vector<std::string> drones_named(hive::Application& application, const std::vector<std::string>& words,
                                      Outcome& outcome)
{
    std::vector<std::string> names;
    for (const auto& word : words)
        outcome.attempt(word, [&] { add_new(names, application.find(word)); });
    return names;
}

std::vector<hive::Endpoint> endpoints_named(hive::Application& application, const std::vector<std::string>& words)
{
    std::vector<hive::Endpoint> endpoints;
    for (const auto& word : words)
        add_new(endpoints, is_glob(word) ? matching(application, word) : std::vector{application.endpoint(word)});
    return endpoints;
}

std::vector<hive::Endpoint> endpoints_named(hive::Application& application, const std::vector<std::string>& words,
                                            Outcome& outcome)
{
    std::vector<hive::Endpoint> endpoints;
    for (const auto& word : words)
        outcome.attempt(word, [&] { add_new(endpoints, endpoints_named(application, {word})); });
    return endpoints;
}

std::string usual_output(const hive::Interface& interface, const std::string& drone, std::string_view preferred)
{
    const auto is_preferred = [&](const hive::Port& port) { return port.type.find(preferred) != std::string::npos; };
    const bool only = std::ranges::count_if(interface.outputs, is_preferred) == 1;
    return hive::port_meant(interface.outputs, drone, "output", "",
                            [&](const hive::Port& port) { return !only || is_preferred(port); })
        .name;
}

std::vector<hive::Endpoint> outputs_named(hive::Application& application, const std::vector<std::string>& words,
                                          std::string_view preferred, Outcome& outcome)
{
    std::vector<hive::Endpoint> outputs;
    for (auto& output : endpoints_named(application, words, outcome))
        outcome.attempt(to_text(output), [&] {
            const Waiting waiting(output.drone + " to answer");
            const auto interface = application.describe(output.drone);
            if (output.port.empty())
                output.port = usual_output(interface, output.drone, preferred);
            else if (output.port != "exceptions")  // every drone has this output, and no interface lists it
                hive::port_named(interface.outputs, output.drone, "output", output.port);
            add_new(outputs, {output});
        });
    return outputs;
}

std::string usual_input(const hive::Interface& interface, const std::string& drone, const std::string& type)
{
    return hive::port_meant(interface.inputs, drone, "input", "that takes " + type,
                            [&](const hive::Port& port) { return hive::types_fit(type, port.type); })
        .name;
}

hive::Endpoint output_named(hive::Application& application, const std::string& word, std::string_view preferred)
{
    const Waiting waiting(word + " to answer");
    auto output = application.endpoint(word);
    if (output.port.empty())
        output.port = usual_output(application.describe(output.drone), output.drone, preferred);
    return output;
}

hive::Endpoint input_named(hive::Application& application, const std::string& word, const std::string& type)
{
    const Waiting waiting(word + " to answer");
    auto input = application.endpoint(word);
    if (input.port.empty())
        input.port = usual_input(application.describe(input.drone), input.drone, type);
    return input;
}

}  // namespace hivectl
