// The table of error codes: token, sentence, advice.
#include <hive/error.hpp>

#include <algorithm>
#include <array>

namespace hive {
namespace {

constexpr std::array table{
    ErrorInfo{Errc::invalid_argument, "invalid_argument", "invalid argument", "correct the call", 2},
    ErrorInfo{Errc::not_found, "not_found", "there is no such thing", "check the name", 3},
    ErrorInfo{Errc::unreachable, "unreachable", "no answer there", "start it, or check the address", 4},
    ErrorInfo{Errc::connection_lost, "connection_lost", "the peer went away", "try again; the outcome is not known", 4},
    ErrorInfo{Errc::timeout, "timeout", "no answer in time", "allow more time, or look what it is busy with", 124},
    ErrorInfo{Errc::refused, "refused", "the drone refused", "", 5},
    ErrorInfo{Errc::type_mismatch, "type_mismatch", "output and input do not fit", "connect other ports", 6},
    ErrorInfo{Errc::halted, "halted", "the drone has halted", "resume it", 7},
    ErrorInfo{Errc::locked, "locked", "another set is in progress there", "try again in a moment", 5},
    ErrorInfo{Errc::name_taken, "name_taken", "the name is in use", "choose another name, or stop that drone", 1},
    ErrorInfo{Errc::not_permitted, "not_permitted", "that is not allowed", "use the right account", 5},
    ErrorInfo{Errc::too_large, "too_large", "over the limit", "send less, or have the operator raise the limit", 5},
    ErrorInfo{Errc::malformed, "malformed", "protocol error", "check what talks to this socket", 1},
    ErrorInfo{Errc::version_mismatch, "version_mismatch", "protocol version mismatch", "use matching versions", 1},
    ErrorInfo{Errc::unsupported, "unsupported", "unknown request", "use matching versions", 5},
    ErrorInfo{Errc::failed, "failed", "the drone's code failed", "read the text, correct the drone or its input", 1},
    ErrorInfo{Errc::abandoned, "abandoned", "given up after several attempts", "look at the input and the workers", 1},
    ErrorInfo{Errc::stopped, "stopped", "the module is ending", "start it again", 4},
    ErrorInfo{Errc::io, "io", "the operating system refused", "read the text", 1},
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

}  // namespace

const ErrorInfo& info(Errc code) noexcept { return table[static_cast<std::size_t>(code)]; }

Errc errc_from_token(std::string_view token) noexcept
{
    const auto row = std::ranges::find(table, token, &ErrorInfo::token);
    return row == table.end() ? Errc::failed : row->code;
}

void require_at_most(std::string_view what, std::uint64_t bytes, std::uint64_t limit, const std::string& advice)
{
    if (bytes > limit)
        throw Error(Errc::too_large,
                    std::string(what) + " of " + std::to_string(bytes) + " bytes, limit " + std::to_string(limit),
                    advice);
}

Error current_error()
try {
    throw;
} catch (const Error& error) {
    return error;
} catch (const std::exception& error) {
    return {Errc::failed, error.what()};
} catch (...) {
    return {Errc::failed, "a non-exception object was thrown"};
}

}  // namespace hive
