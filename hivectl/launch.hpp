// Runs the program of a drone and waits until it answers.
#pragma once

#include "background.hpp"

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hivectl {

class Session;

/// What is to run, and for which verb: complaints name it.
struct LaunchPlan {
    std::string verb, kind, name;        ///< kind: "face", or a file of Python, "edges.py"
    std::vector<std::string> arguments;  ///< of the program, but its name
    Life life = Life::own;
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
    [[nodiscard]] BackgroundProcess& process() { return process_; }
    [[nodiscard]] std::filesystem::path log() const;

private:
    [[nodiscard]] bool ready();
    int give_up(bool late, std::chrono::milliseconds limit);
    void show_last_words() const;

    Session& session_;
    LaunchPlan plan_;
    BackgroundProcess process_;
    bool was_ready_ = false;
};

/// Starts a drone for good and prints its name when it is ready. Returns the exit code.
int start_in_background(Session& session, const LaunchPlan& plan);

}  // namespace hivectl
