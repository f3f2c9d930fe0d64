// The loop of the verbs that print events.
#include "run/printing.hpp"

#include "words/exit_code.hpp"
#include "words/format.hpp"
#include "run/interrupt.hpp"
#include "words/output.hpp"
#include "words/status_line.hpp"

#include <algorithm>

namespace hivectl {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

int exit_code_at_end(const std::string& verb, const std::string& text)
{
    if (text.empty())
        return exit_code::done;
    complain(verb, "incomplete: " + printable(text));
    return exit_code::partly_done;
}

int print_lines(const PrintUntil& until,
                const std::function<std::optional<std::string>(std::chrono::milliseconds)>& next)
{
    const interrupt::Deferred deferred;
    constexpr auto silence = 3s;
    auto last = Clock::now();
    Waiting waiting(until.what);
    bool told = false;
    for (std::int64_t printed = 0; !interrupt::requested();) {
        if (const auto line = next(std::min(until.timeout.value_or(100ms), 100ms))) {
            write_out(*line);
            if (++printed == until.count)
                return exit_code::done;
            last = Clock::now();
            waiting.again();
            told = false;
        } else if (const auto end = until.ended ? until.ended() : std::nullopt) {
            return exit_code_at_end(until.verb, *end);
        } else if (until.timeout && Clock::now() - last >= *until.timeout) {
            return fail(until.verb, hive::Errc::timeout,
                        "no event for " + duration_text(*until.timeout / 1us)
                            + (until.reason ? "; " + until.reason() : ""));
        } else if (until.silence && Clock::now() - last >= silence && !std::exchange(told, true)) {
            until.silence();
        }
    }
    return interrupt::exit_code();
}

}  // namespace hivectl
