// Prints one line of progress, and the failures.
#include "run/swarm_work.hpp"

#include "words/exit_code.hpp"
#include "words/failures.hpp"
#include "words/output.hpp"
#include "words/table.hpp"

namespace hivectl {

SwarmWork::SwarmWork(const std::string& verb)
{
    watch_.cancelled = interrupt::requested;
    watch_.told = [verb](const std::string& text) { complain(verb, printable(text)); };
    watch_.on_progress = [this](std::size_t done, std::size_t all, const std::string& what) {
        progress_ = " (" + std::to_string(done) + " of " + std::to_string(all) + " " + what + ")";
        show();
    };
    watch_.on_waiting = [this](const std::vector<std::string>& drones) {
        drones_ = names_text(drones);
        show();
    };
}

void SwarmWork::show() { waiting_.now_for(drones_ + progress_); }

int complain_about(std::string_view verb, const hive::SwarmOutcome& outcome)
{
    complain_about(verb, outcome.failures);
    const std::string subject = outcome.failures.empty() ? "cannot stop: " : "not undone: ";
    auto remains = outcome.remains;
    for (auto& [drone, error] : remains)
        error = error.reworded(subject + error.what());
    complain_about(verb, remains);
    complain_about(verb, outcome.silent);
    if (interrupt::requested())
        return interrupt::exit_code();
    if (!outcome.failures.empty())
        return exit_code::refused;
    return outcome.remains.empty() && outcome.silent.empty() ? exit_code::done : exit_code::partly_done;
}

}  // namespace hivectl
