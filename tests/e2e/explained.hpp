// Runs hivectl explain, and the commands that it proposes.
#pragma once

#include "status_sums.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <sstream>

namespace hive::test {

/// One explanation.
struct Found {
    Json json;
    std::string causes{};  ///< "halted source, halted worker", but for the load of the machine, where tests run beside
    int exit_code = -1;

    [[nodiscard]] bool runs() const { return exit_code == 0 && causes.empty(); }
    [[nodiscard]] std::string text() const { return json.dump(2); }
    [[nodiscard]] std::string command() const { return of_first("command"); }
    [[nodiscard]] std::string evidence() const { return of_first("evidence"); }

private:
    [[nodiscard]] std::string of_first(const char* key) const
    {
        return causes.empty() ? "" : json.at("causes").at(0).at(key).get<std::string>();
    }
};

/// @param words  "explain worker"
inline Found found(const Swarm& swarm, const std::string& words)
{
    std::istringstream in(words + " --json");
    const auto done = swarm.hivectl({std::istream_iterator<std::string>(in), {}});
    if (done.exit_code != 0 && done.exit_code != 9)
        throw std::runtime_error(words + " exited with " + std::to_string(done.exit_code) + ": " + done.err);
    Found found{.json = Json::parse(done.out), .exit_code = done.exit_code};
    for (const auto& cause : found.json.at("causes"))
        if (cause.at("what") != "load")
            found.causes += (found.causes.empty() ? "" : ", ") + cause.at("what").get<std::string>() + " "
                            + cause.at("drone").get<std::string>();
    return found;
}

/// Runs the command for the first cause, as a user who pastes it.
inline void cure(const Swarm& swarm, const Found& found)
{
    const auto done = swarm.run({"/bin/sh", "-c", found.command()});
    CHECK_MESSAGE(done.exit_code == 0, found.text(), "\n", done.out, done.err);
}

inline std::int64_t processed(Application& application, const std::string& drone)
{
    return at_inputs(application.status(drone), &InputStatus::processed);
}

}  // namespace hive::test
