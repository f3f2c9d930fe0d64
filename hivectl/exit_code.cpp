// The one table from error codes to exit codes and advice.
#include "exit_code.hpp"

#include "output.hpp"

#include <array>

namespace hivectl {
namespace {

using hive::Errc;

struct Entry {
    Errc code;
    int exit;
    std::string_view advice;  ///< what to do at a shell; empty when only the text can tell
};

constexpr std::array table{
    Entry{Errc::invalid_argument, exit_code::usage, ""},
    Entry{Errc::not_found, exit_code::not_found, "see the names: hivectl ps, hivectl describe NAME"},
    Entry{Errc::unreachable, exit_code::unreachable, "see what runs: hivectl ps"},
    Entry{Errc::connection_lost, exit_code::unreachable, "see whether it still runs: hivectl ps"},
    Entry{Errc::timeout, exit_code::timed_out, "see what it is busy with: hivectl ps, or allow more time: --timeout SECONDS"},
    Entry{Errc::refused, exit_code::refused, ""},
    Entry{Errc::type_mismatch, exit_code::type_mismatch, "see the ports: hivectl describe NAME"},
    Entry{Errc::halted, exit_code::halted, "let it go on: hivectl resume NAME"},
    Entry{Errc::name_taken, exit_code::failure, "choose another name: --as NAME, or stop the holder: hivectl stop NAME"},
    Entry{Errc::not_permitted, exit_code::refused, "use the account that started the drone"},
    Entry{Errc::too_large, exit_code::refused, "send less"},
    Entry{Errc::malformed, exit_code::failure, ""},
    Entry{Errc::version_mismatch, exit_code::failure, "use a hivectl and drones of the same version"},
    Entry{Errc::unsupported, exit_code::refused, "use a hivectl and drones of the same version"},
    Entry{Errc::failed, exit_code::failure, "see its exceptions: hivectl exceptions NAME"},
    Entry{Errc::abandoned, exit_code::failure, "see the exceptions: hivectl exceptions"},
    Entry{Errc::stopped, exit_code::unreachable, "start it again: hivectl start KIND"},
    Entry{Errc::io, exit_code::failure, ""},
};

constexpr bool in_order()
{
    for (std::size_t i = 0; i < table.size(); ++i)
        if (static_cast<std::size_t>(table[i].code) != i)
            return false;
    return true;
}
static_assert(in_order(), "the table is indexed by the enumerator");
static_assert(table.size() == static_cast<std::size_t>(Errc::io) + 1);

const Entry& entry(Errc code) noexcept { return table[static_cast<std::size_t>(code)]; }

}  // namespace

int exit_code_of(Errc code) noexcept { return entry(code).exit; }

std::string explained(const hive::Error& error)
{
    const std::string text = printable(error.what());
    const auto advice = entry(error.code()).advice;
    // A text with a semicolon, or with the nearest name, has said already what to do.
    const bool told = text.find("; ") != std::string::npos || text.find("did you mean") != std::string::npos;
    return told || advice.empty() ? text : text + "; " + std::string(advice);
}

void Outcome::failed(std::string_view subject, const hive::Error& error)
{
    codes_.insert(exit_code_of(error.code()));
    std::string text = explained(error);
    if (text.find(subject) == std::string::npos)
        text = printable(subject) + ": " + text;
    complain(verb_, text);
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
