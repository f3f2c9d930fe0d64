// Advice for errors at a shell, and the exit code of a verb with several subjects.
#include "words/exit_code.hpp"

#include "words/output.hpp"

#include <hive/failure.hpp>
#include <hive/program.hpp>

namespace hivectl {
namespace {

using hive::Errc;

bool as_json = false;  ///< failures

/// A command, with DRONE for the drone's name; empty if only the error's text has one.
std::string advice_on(Errc code)
{
    switch (code) {
    case Errc::not_found: return "see the names: hivectl ps, hivectl describe DRONE";
    case Errc::unreachable: return "see what runs: hivectl ps";
    case Errc::connection_lost: return "see whether it still runs: hivectl ps";
    case Errc::timeout: return "see what it is busy with: hivectl ps, or allow more time: --timeout SECONDS";
    case Errc::type_mismatch: return "see the ports: hivectl describe DRONE";
    case Errc::halted: return "resume it: hivectl resume DRONE";
    case Errc::locked: return "try again, or allow more time: --timeout SECONDS";
    case Errc::name_taken: return "choose another name: --as NAME, or stop that drone: hivectl stop NAME";
    case Errc::not_permitted: return "use the account that started the drone";
    case Errc::too_large: return "send less";
    case Errc::version_mismatch:
    case Errc::unsupported: return "use a hivectl and drones of the same version";
    case Errc::failed: return "see its exceptions: hivectl exceptions DRONE";
    case Errc::abandoned: return "see the exceptions: hivectl exceptions";
    case Errc::invalid_argument:
    case Errc::refused:
    case Errc::malformed:
    case Errc::stopped:
    case Errc::io: break;
    }
    return "";
}

/// @param subject  "face" or "face.image"; empty: unknown
std::string usual_advice(Errc code, std::string_view subject)
{
    constexpr std::string_view place = "DRONE";
    auto advice = advice_on(code);
    const std::string drone(subject.empty() ? "NAME" : subject.substr(0, subject.find('.')));
    if (const auto at = advice.find(place); at != std::string::npos)
        advice.replace(at, place.size(), drone);
    return advice;
}

}  // namespace

int exit_code_of(Errc code) noexcept { return hive::info(code).exit_code; }

std::string advice_for_missing(const std::string& drone)
{
    const auto kind = hive::kind_by_name(drone);
    return kind ? "start it: " + hive::start_command(*kind, drone) : "see what runs: hivectl ps";
}

std::string explained(const hive::Error& error, std::string_view subject)
{
    const auto advice = error.advice().empty() ? usual_advice(error.code(), subject) : error.advice();
    return printable(error.what() + (advice.empty() ? "" : "; " + advice));
}

void print_failures_as_json() { as_json = true; }
bool prints_failures_as_json() { return as_json; }

void complain_about(std::string_view verb, const hive::Error& error, std::string_view subject)
{
    const std::string_view text = error.what();
    if (as_json) {
        const auto advice = error.advice().empty() ? usual_advice(error.code(), subject) : error.advice();
        return write_error(json_text(hive::failure_json({error.code(), error.what(), advice}, std::string(subject)))
                           + "\n");
    }
    const auto before = text.find(subject) == std::string_view::npos ? std::string(subject) + ": " : "";
    if (text.find('\n') == std::string_view::npos)
        return complain(verb, printable(before) + explained(error, subject));
    complain_in_lines(verb, before + error.what() + (error.advice().empty() ? "" : "\n" + error.advice()));
}

int fail(std::string_view verb, hive::Errc code, const std::string& sentence, std::string_view subject)
{
    if (as_json)
        write_error(json_text(hive::failure_json({code, sentence}, std::string(subject))) + "\n");
    else
        complain(verb, printable(sentence));
    return exit_code_of(code);
}

void Outcome::failed(std::string_view subject, const hive::Error& error)
{
    codes_.insert(exit_code_of(error.code()));
    complain_about(verb_, error, subject);
}

int exit_code_of_failure(std::string_view verb, std::string_view subject, const hive::Error& error)
{
    Outcome outcome(verb);
    outcome.failed(subject, error);
    return outcome.exit_code();
}

int Outcome::exit_code(int code) const
{
    return code == exit_code::done && !codes_.empty() ? exit_code::partly_done : code;
}

int Outcome::exit_code() const
{
    if (codes_.empty())
        return exit_code::done;
    if (done_ > 0)
        return exit_code::partly_done;
    return codes_.size() == 1 ? *codes_.begin() : exit_code::failure;
}

}  // namespace hivectl
