// One line of progress, and the failures drone by drone.
#include "swarm_work.hpp"

#include "exit_code.hpp"
#include "output.hpp"
#include "table.hpp"

#include <iostream>
#include <sstream>
#include <unistd.h>
#include <utility>

namespace hivectl {
namespace {

/// A log may be among it, so each line is one.
void complain_in_lines(std::string_view verb, const std::string& subject, const std::string& text)
{
    std::istringstream lines(text);
    bool first = true;
    for (std::string line; std::getline(lines, line); first = false)
        complain(verb, (first && !line.starts_with(subject) ? subject + ": " : first ? "" : "  ") + printable(line));
}

std::string with_advice(const hive::Error& error)
{
    return error.advice().empty() ? error.what() : std::string(error.what()) + "; " + error.advice();
}

}  // namespace

SwarmWork::SwarmWork(const std::string& verb)
{
    watch_.cancelled = interrupt::requested;
    watch_.told = [this, verb](const std::string& text) {
        clear();
        complain(verb, printable(text));
    };
    if (::isatty(STDERR_FILENO) != 0)
        watch_.on_progress = [this](std::size_t done, std::size_t all, const std::string& what) {
            shown_ = true;
            std::cerr << '\r' << done << " of " << all << ' ' << what << "\x1b[K" << std::flush;
        };
}

SwarmWork::~SwarmWork() { clear(); }

void SwarmWork::clear()
{
    if (std::exchange(shown_, false))
        std::cerr << "\r\x1b[K" << std::flush;
}

int complain_about(std::string_view verb, const hive::SwarmOutcome& outcome)
{
    for (const auto& failure : outcome.failures)
        complain_in_lines(verb, failure.drone, with_advice(failure.error));
    const std::string remains = outcome.failures.empty() ? "could not be ended: " : "not undone: ";
    for (const auto& failure : outcome.remains)
        complain_in_lines(verb, failure.drone, remains + with_advice(failure.error));
    if (interrupt::requested())
        return interrupt::exit_code();
    if (!outcome.failures.empty())
        return exit_code::refused;
    return outcome.remains.empty() ? exit_code::done : exit_code::partly_done;
}

}  // namespace hivectl
