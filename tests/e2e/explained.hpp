// Runs hivectl explain, and the commands that it proposes.
#pragma once

#include "status_sums.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <cstdlib>
#include <fstream>
#include <functional>

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
        for (const auto& cause : json.is_null() ? Json::array() : json.at("causes"))
            if (cause.at("what") != "load")
                return cause.at(key).get<std::string>();
        return "";
    }
};

/// Runs lines as a user types them, in a swarm.
class Shell {
public:
    /// @param inside  the command that runs another one on the machine, if it is one of a lab
    Shell(const Swarm& swarm, const std::vector<std::string>& inside = {})
        : run_([&swarm, inside](const std::string& line) {
              auto all = inside;
              all.insert(all.end(), {"/bin/sh", "-c", line});
              return swarm.run(all);
          })
    {
    }
    explicit Shell(std::function<Finished(const std::string& line)> run) : run_(std::move(run)) {}
    [[nodiscard]] Finished run(const std::string& line) const { return run_(line); }

private:
    std::function<Finished(const std::string& line)> run_;
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

/// Adds a row for explain_count.py.
inline void note(Json row)
{
    const char* const file = std::getenv("HIVE_EXPLAINED");
    if (!file)
        return;
    static int number = 0;
    const auto* options = doctest::getContextOptions();
    row["program"] = options->binary_name.c_str();
    row["case"] = options->currentTest->m_name;
    row["number"] = ++number;
    std::ofstream(file, std::ios::app) << row << "\n";
}

/// possible() for a case that injects a cause.
inline bool injectable(const std::string& missing)
{
    if (!missing.empty())
        note({{"skipped", missing}});
    return possible(missing);
}

/// Notes which cause was injected, and which one hivectl explain named first.
/// @param injected  "halted source"
/// @param first     the first explanation after that which has a cause
inline void count(const std::string& injected, const Found& first)
{
    Json named;
    for (const auto& cause : first.json.is_null() ? Json::array() : first.json.at("causes"))
        if (named.is_null() && (cause.at("what") != "load" || injected.starts_with("load ")))
            named = cause;
    note({{"injected", injected}, {"named", named}});
}

/// The explanation, once it is this one. Call it when the cause is in effect: the first cause that is named counts.
inline Found awaited(const Shell& shell, const std::string& words, const std::string& causes,
                     Milliseconds timeout = Milliseconds(15'000))
{
    Found now, first;
    CHECK_MESSAGE(eventually(
                      [&] {
                          now = found(shell, words);
                          if (first.causes.empty())
                              first = now;
                          return now.causes == causes;
                      },
                      timeout),
                  now.text());
    count(causes.substr(0, causes.find(',')), first);
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
