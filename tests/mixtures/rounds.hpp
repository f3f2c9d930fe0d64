// The command line of a program that plays rounds.
#pragma once

#include "round.hpp"

#include <CLI/CLI.hpp>

#include <functional>

namespace hive::mixtures {

using Play = std::function<Played(const Plan&)>;

/// Plays what the command line says, prints what failed, and how to play that again. @return the exit code
/// @param faults  that can be asked for with --with; otherwise each seed draws some of them
int play_rounds(CLI::App& app, int argc, char** argv, const Play& play, const std::set<std::string>& faults = {});

}  // namespace hive::mixtures
