// The loop of the verbs that print what comes.
#include "printing.hpp"

#include "exit_code.hpp"
#include "format.hpp"
#include "interrupt.hpp"
#include "output.hpp"

#include <algorithm>

namespace hivectl {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

int print_lines(const PrintUntil& until,
                const std::function<std::optional<std::string>(std::chrono::milliseconds)>& next)
{
    const interrupt::Deferred deferred;
    auto last = Clock::now();
    for (std::int64_t printed = 0; !interrupt::requested();) {
        if (const auto line = next(std::min(until.patience.value_or(100ms), 100ms))) {
            write_out(*line);
            if (++printed == until.count)
                return exit_code::done;
            last = Clock::now();
        } else if (until.patience && Clock::now() - last >= *until.patience) {
            complain(until.verb, "nothing came for " + duration_text(*until.patience / 1us)
                                     + (until.reason ? "; " + until.reason() : ""));
            return exit_code::timed_out;
        }
    }
    return interrupt::exit_code();
}

}  // namespace hivectl
