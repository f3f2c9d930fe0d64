// The one vocabulary of errors, in memory and on the wire (SPEC.md, section 7).
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace hive {

/// Why something failed. The order is not part of the wire: the token is.
enum class Errc {
    invalid_argument,  ///< a value, a name or a call that is always invalid
    not_found,         ///< no such drone, input, output or parameter
    unreachable,       ///< no answer at that address
    connection_lost,   ///< the peer exited or was disconnected during the operation
    timeout,           ///< the deadline passed before the answer came
    refused,           ///< the drone understood and said no; the text gives its reason
    type_mismatch,     ///< output and input have different types; the text names both
    halted,            ///< the drone has halted and accepts nothing until it is resumed
    locked,            ///< another set is in progress there; retry after a short delay
    name_taken,        ///< a running module has that name already
    not_permitted,     ///< the peer or the user may not do this
    too_large,         ///< over a limit of this end (SPEC.md, section 3)
    malformed,         ///< bytes or JSON that break the protocol
    version_mismatch,  ///< the peer has another version of the protocol
    unsupported,       ///< a request that this module does not implement
    failed,            ///< user code threw
    abandoned,         ///< every attempt at an event failed
    stopped,           ///< the module is stopping
    io                 ///< the operating system refused
};

/// One row of the table behind Errc.
struct ErrorInfo {
    Errc code;
    std::string_view token;     ///< as written on the wire and in --json output
    std::string_view sentence;  ///< what happened
    std::string_view advice;    ///< what the caller can do
    int exit_code;              ///< of a program that exits with this error
};

/// The row of a code.
const ErrorInfo& info(Errc code) noexcept;

/// The code of a wire token; Errc::failed for a token this version does not know.
Errc errc_from_token(std::string_view token) noexcept;

/// Thrown for bad input, peers and the operating system. Normal absence is std::optional instead.
class Error : public std::runtime_error {
public:
    /// @param text    what happened, in one sentence
    /// @param advice  what the caller can do, if more specific than the table's advice for the code
    Error(Errc code, const std::string& text, std::string advice = {})
        : std::runtime_error(text), code_(code), advice_(std::move(advice))
    {
    }
    [[nodiscard]] Errc code() const noexcept { return code_; }
    [[nodiscard]] const std::string& advice() const noexcept { return advice_; }
    /// The same error with another text, such as the old one after "face: ".
    [[nodiscard]] Error reworded(const std::string& text) const { return {code_, text, advice_}; }

private:
    Errc code_;
    std::string advice_;
};

/// Throws Errc::too_large above the limit: "a body of 70000000 bytes, limit 67108864".
void require_at_most(std::string_view what, std::uint64_t bytes, std::uint64_t limit, const std::string& advice = {});

/// For a catch clause: the exception being handled. Any exception other than an Error becomes Errc::failed with its
/// text; so does an object that is not an exception (`throw 42`), with a text that says so.
Error current_error();

}  // namespace hive
