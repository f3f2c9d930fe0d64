// Runs hivectl explain, and the commands that it proposes.
#pragma once

#include "status_sums.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>

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

/// Runs lines as a user types them, in a swarm.
class Shell {
public:
    /// @param inside  the command that runs another one on the machine, if it is one of a lab
    Shell(const Swarm& swarm, const std::vector<std::string>& inside = {}) : swarm_(swarm), words_(inside)
    {
        words_.insert(words_.end(), {"/bin/sh", "-c"});
    }
    [[nodiscard]] Finished run(const std::string& line) const
    {
        auto words = words_;
        words.push_back(line);
        return swarm_.run(words);
    }

private:
    const Swarm& swarm_;
    std::vector<std::string> words_;
};

/// @param words  "explain worker"
inline Found found(const Shell& shell, const std::string& words)
{
    const auto done = shell.run("hivectl " + words + " --json");
    if (done.exit_code != 0 && done.exit_code != 9)
        throw std::runtime_error(words + " exited with " + std::to_string(done.exit_code) + ": " + done.err);
    Found found{.json = Json::parse(done.out), .exit_code = done.exit_code};
    for (const auto& cause : found.json.at("causes"))
        if (cause.at("what") != "load")
            found.causes += (found.causes.empty() ? "" : ", ") + cause.at("what").get<std::string>() + " "
                            + cause.at("drone").get<std::string>();
    return found;
}

/// The explanation, once it is this one.
inline Found awaited(const Shell& shell, const std::string& words, const std::string& causes,
                     Milliseconds patience = Milliseconds(15'000))
{
    Found now;
    CHECK_MESSAGE(eventually(
                      [&] {
                          now = found(shell, words);
                          return now.causes == causes;
                      },
                      patience),
                  now.text());
    return now;
}

inline bool runs(const Shell& shell, const std::string& words)
{
    return eventually([&] { return found(shell, words).runs(); });
}

/// Runs the command for the first cause, as a user who pastes it.
inline void cure(const Shell& shell, const Found& found)
{
    const auto done = shell.run(found.command());
    CHECK_MESSAGE(done.exit_code == 0, found.text(), "\n", done.out, done.err);
}

inline std::int64_t processed(Application& application, const std::string& drone)
{
    return at_inputs(application.status(drone), &InputStatus::processed);
}

}  // namespace hive::test
