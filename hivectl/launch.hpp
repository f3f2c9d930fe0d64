// Runs the program of a drone and waits until it answers.
#pragma once

#include <hive/application.hpp>
#include <hive/process.hpp>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hivectl {

class Session;

/// What is to run, and for which verb: complaints name it.
struct LaunchPlan {
    std::string verb, kind, name;        ///< kind: "face", or a file of Python, "edges.py"
    std::vector<std::string> arguments;  ///< of the program, but its name
    hive::BackgroundProcess::Life life = hive::BackgroundProcess::Life::own;
};

/// A drone started here.
class Launch {
public:
    /// Starts it, with its log in the home. Throws Errc::not_found when there is no such program, Errc::name_taken,
    /// Errc::io.
    Launch(Session& session, LaunchPlan plan);

    /// Waits until it is ready. If it never will be, it is gone, stderr says why, and this is the exit code. Throws
    /// Errc::name_taken when another has taken the name meanwhile.
    std::optional<int> await(std::chrono::milliseconds limit);
    /// Says on stderr how it ended, and its last words. Returns its exit code if that is one of ours.
    int died(int status) const;
    [[nodiscard]] hive::BackgroundProcess& process() { return process_; }
    [[nodiscard]] std::filesystem::path log() const;
    [[nodiscard]] const std::string& name() const { return plan_.name; }

private:
    [[nodiscard]] bool ready();
    int give_up(bool late, std::chrono::milliseconds limit);
    void show_last_words() const;

    Session& session_;
    LaunchPlan plan_;
    hive::BackgroundProcess process_;
    bool was_ready_ = false;
};

/// Throws Errc::name_taken, with its place, when a drone of the swarm has the name.
void require_free(hive::Application& application, std::string_view verb, const std::string& kind,
                  const std::string& name);

/// Ends a drone that is tied to a command, whichever way the command ends; nothing of it is left. The log belongs to
/// whoever has the name.
class Removal {
public:
    Removal(Launch& launch, hive::Application& application) : launch_(launch), application_(application) {}
    ~Removal();
    Removal(const Removal&) = delete;
    Removal& operator=(const Removal&) = delete;

private:
    Launch& launch_;
    hive::Application& application_;
};

/// Calls it with the first of NAME, NAME-2, NAME-3 ... that nobody has: it throws Errc::name_taken for the others.
int as_first_free(const std::string& name, const std::function<int(const std::string&)>& call);

/// Starts a drone for good and prints its name when it is ready. Returns the exit code.
/// @param if_missing  one of this name and kind that runs here already is found and printed instead
int start_in_background(Session& session, const LaunchPlan& plan, bool if_missing = false);

}  // namespace hivectl
