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
    invalid_argument,  ///< a value, a name or a call that can never be right
    not_found,         ///< no such drone, input, output or parameter
    unreachable,       ///< nobody answers at that address
    connection_lost,   ///< the peer ended or was cut off while something was under way
    timeout,           ///< the deadline passed before the answer came
    refused,           ///< the drone understood and said no; the text gives its reason
    type_mismatch,     ///< output and input speak different types; the text names both
    halted,            ///< the drone has halted and takes nothing until it is resumed
    locked,            ///< another set is being decided there; it takes moments
    name_taken,        ///< a living module has that name already
    not_permitted,     ///< the peer or the user may not do this
    too_large,         ///< over a limit of this end (SPEC.md, section 3)
    malformed,         ///< bytes or JSON that break the protocol
    version_mismatch,  ///< the peer speaks another version of the protocol
    unsupported,       ///< a request that this module does not know
    failed,            ///< user code threw
    abandoned,         ///< every attempt at an event failed; it is given up
    stopped,           ///< the module is ending
    io                 ///< the operating system refused
};

/// One row of the table behind Errc.
struct ErrorInfo {
    Errc code;
    std::string_view token;     ///< as written on the wire and in --json output
    std::string_view sentence;  ///< what happened
    std::string_view advice;    ///< what the caller can do
    int exit_code;              ///< of a program that ends with it
};

/// The row of a code.
const ErrorInfo& info(Errc code) noexcept;

/// The code of a wire token; Errc::failed for a token this version does not know.
Errc errc_from_token(std::string_view token) noexcept;

/// What Hive throws for bad input, peers and the operating system. Normal absence is std::optional instead.
class Error : public std::runtime_error {
public:
    /// @param text    what happened, in one sentence
    /// @param advice  what the caller can do about it, when more can be said than the table says for the code
    Error(Errc code, const std::string& text, std::string advice = {})
        : std::runtime_error(text), code_(code), advice_(std::move(advice))
    {
    }
    [[nodiscard]] Errc code() const noexcept { return code_; }
    [[nodiscard]] const std::string& advice() const noexcept { return advice_; }
    /// The same error in other words: "face: " and what it said.
    [[nodiscard]] Error reworded(const std::string& text) const { return {code_, text, advice_}; }

private:
    Errc code_;
    std::string advice_;
};

/// Throws Errc::too_large for more: "a body of 70000000 bytes, limit 67108864".
void require_at_most(std::string_view what, std::uint64_t bytes, std::uint64_t limit, const std::string& advice = {});

/// For a catch clause: what is being handled there. Another exception than an Error becomes Errc::failed with its text,
/// and so does what is no exception at all (`throw 42`), with a text that says so.
Error current_error();

}  // namespace hive
