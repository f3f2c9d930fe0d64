// Plays rounds, each from a seed of its own, until the time is over or one fails; a seed plays its round again.
#include "rounds.hpp"
#include "shrink.hpp"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <limits>
#include <optional>
#include <random>

namespace hive::mixtures {
namespace {

struct Options {
    std::optional<std::uint64_t> seed, from;
    int steps = 14, rounds = 0, seconds = 60;
    bool go_on = false, plan_only = false, shrink = false;
    std::string until;
    std::set<std::string> faults;
};

bool has(const Problems& problems, const std::string& text)
{
    return std::ranges::any_of(problems, [&](const auto& problem) { return problem.find(text) != std::string::npos; });
}

void print(const Plan& plan, const Played& played)
{
    std::cout << "seed " << plan.seed << ": " << to_text(plan.topology) << "\n";
    for (std::size_t i = 0; i < plan.steps.size() && i < played.steps; ++i)
        std::cout << (i + 1 == played.steps && !played.problems.empty() ? "  > " : "    ") << i + 1 << "  "
                  << to_text(plan.steps[i]) << "\n";
    constexpr std::size_t most = 12;
    for (std::size_t i = 0; i < played.problems.size() && i < most; ++i)
        std::cout << "  FAILED: " << played.problems[i] << "\n";
    if (played.problems.size() > most)
        std::cout << "  ... and " << played.problems.size() - most << " more\n";
}

/// What has found it: the word before the colon.
std::string finder_of(const Played& played)
{
    return played.problems.front().substr(0, played.problems.front().find(':'));
}

void print_shrunk(const Plan& plan, const Played& played, const Play& play)
{
    int plays = 0;
    const auto shorter = shrunk(plan, [&](const Plan& tried) {
        ++plays;
        const auto again = play(tried);
        return !again.problems.empty() && finder_of(again) == finder_of(played);
    });
    std::cout << "after " << plays << " plays of shorter rounds:\n";
    print(shorter, play(shorter));
}

int play_rounds(const Options& options, const std::string& program, const Play& play,
                const std::set<std::string>& faults)
{
    const auto first = options.seed ? *options.seed : options.from ? *options.from : std::random_device()();
    const int rounds = options.rounds > 0 ? options.rounds : options.seed ? 1 : std::numeric_limits<int>::max();
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(options.seconds);
    std::size_t seeds = 0, steps = 0, failed = 0;
    for (int i = 0; i < rounds && (options.rounds > 0 || options.seed || std::chrono::steady_clock::now() < end); ++i) {
        const auto seed = first + static_cast<std::uint64_t>(i);
        const auto plan =
            make_plan(seed, options.steps, options.faults.empty() ? draw_faults(seed, faults) : options.faults);
        const auto played = options.plan_only ? Played{plan.steps.size(), {}, {}} : play(plan);
        ++seeds;
        steps += played.steps;
        if (options.plan_only || !played.problems.empty())
            print(plan, played);
        if (played.problems.empty())
            continue;
        ++failed;
        std::cout << played.picture << "\n  to play it again: " << program << " " << options_of(plan) << std::endl;
        if (options.shrink)
            print_shrunk(plan, played, play);
        if (!options.go_on && has(played.problems, options.until))
            break;
    }
    std::cout << seeds << " seeds from " << first << ", " << steps << " steps, " << failed << " failed" << std::endl;
    return failed > 0 ? 1 : 0;
}

}  // namespace

int play_rounds(CLI::App& app, int argc, char** argv, const Play& play, const std::set<std::string>& faults)
{
    Options options;
    app.add_option("--seed", options.seed, "play this round, instead of others for --seconds");
    app.add_option("--from", options.from, "begin with this seed instead of a random one");
    app.add_option("--steps", options.steps, "of a round, about")->capture_default_str();
    app.add_option("--rounds", options.rounds, "so many, whatever time they take; 0: as --seconds says");
    app.add_option("--seconds", options.seconds, "begin no round after that")->capture_default_str();
    app.add_flag("--go-on", options.go_on, "also after a round that failed");
    app.add_option("--until", options.until, "go on after a round that failed, but for one with this in a problem");
    app.add_flag("--plan", options.plan_only, "print the rounds and play none");
    app.add_flag("--shrink", options.shrink, "leave out steps of a round that failed while it fails in the same way");
    auto words = faults;
    words.insert(fault::none);
    if (!faults.empty())
        app.add_option("--with", options.faults, "these further faults instead of some drawn from the seed")
            ->check(CLI::IsMember(words));
    CLI11_PARSE(app, argc, argv);
    return play_rounds(options, app.get_name(), play, faults);
}

}  // namespace hive::mixtures
