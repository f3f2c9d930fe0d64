// Converts errors to codes, and keeps the last error of each thread.
#include "errors.hpp"

#include <hive/version.hpp>

#include <array>
#include <optional>

namespace hive::c {
namespace {

struct LastError {
    hive_code code = HIVE_OK;
    std::string text, advice;
};

LastError& last_error()
{
    thread_local LastError error;
    return error;
}

/// In the order of Errc; a code is the position, from 1.
constexpr std::array codes{HIVE_INVALID_ARGUMENT,
                           HIVE_NOT_FOUND,
                           HIVE_UNREACHABLE,
                           HIVE_CONNECTION_LOST,
                           HIVE_TIMEOUT,
                           HIVE_REFUSED,
                           HIVE_TYPE_MISMATCH,
                           HIVE_HALTED,
                           HIVE_LOCKED,
                           HIVE_NAME_TAKEN,
                           HIVE_NOT_PERMITTED,
                           HIVE_TOO_LARGE,
                           HIVE_MALFORMED,
                           HIVE_VERSION_MISMATCH,
                           HIVE_UNSUPPORTED,
                           HIVE_FAILED,
                           HIVE_ABANDONED,
                           HIVE_STOPPED,
                           HIVE_IO};

constexpr bool in_order()
{
    for (std::size_t i = 0; i < codes.size(); ++i)
        if (codes[i] != static_cast<int>(i) + 1)
            return false;
    return true;
}
static_assert(in_order());
static_assert(codes.size() == static_cast<std::size_t>(Errc::io) + 1, "each Errc has a code");

bool is_error(hive_code code) noexcept { return code >= 1 && code <= static_cast<hive_code>(codes.size()); }

/// The row of an error, or nothing.
const ErrorInfo* row_of(hive_code code) noexcept
{
    return is_error(code) ? &info(static_cast<Errc>(code - 1)) : nullptr;
}

}  // namespace

hive_code code_of(Errc code) noexcept { return static_cast<hive_code>(code) + 1; }
Errc errc_of(hive_code code) noexcept { return is_error(code) ? static_cast<Errc>(code - 1) : Errc::failed; }

hive_code keep(const Error& error) noexcept
try {
    auto& last = last_error();
    last.code = code_of(error.code());
    last.text = error.what();
    last.advice = error.advice().empty() ? std::string(info(error.code()).advice) : error.advice();
    return last.code;
} catch (...) {
    return HIVE_FAILED;  // no memory for the text
}

hive_code keep_current() noexcept
try {
    return keep(current_error());
} catch (...) {
    return HIVE_FAILED;
}

void require_done(hive_code code)
{
    if (code == HIVE_OK)
        return;
    const auto& last = last_error();
    const Errc errc = errc_of(code);
    throw Error(errc, last.code == code && !last.text.empty() ? last.text : std::string(info(errc).sentence));
}

void forget_error() noexcept
{
    auto& last = last_error();
    last.code = HIVE_OK;
    last.text.clear();
    last.advice.clear();
}

}  // namespace hive::c

using namespace hive;
using namespace hive::c;

hive_code hive_error_code(void) { return last_error().code; }
const char* hive_error_text(void) { return last_error().text.c_str(); }
const char* hive_error_advice(void) { return last_error().advice.c_str(); }

hive_code hive_fail(hive_code code, const char* text)
{
    const Errc errc = errc_of(code);
    return guarded([&] { throw Error(errc, text ? std::string(text) : std::string(info(errc).sentence)); });
}

// The texts of the table are literals, so they end with a zero byte.
const char* hive_code_token(hive_code code)
{
    const auto* row = row_of(code);
    return row ? row->token.data() : code == HIVE_OK ? "ok" : nullptr;
}

const char* hive_code_sentence(hive_code code)
{
    const auto* row = row_of(code);
    return row ? row->sentence.data() : code == HIVE_OK ? "done" : nullptr;
}

const char* hive_code_advice(hive_code code)
{
    const auto* row = row_of(code);
    return row ? row->advice.data() : code == HIVE_OK ? "" : nullptr;
}

int hive_code_exit_code(hive_code code)
{
    const auto* row = row_of(code);
    return row ? row->exit_code : code == HIVE_OK ? 0 : -1;
}

const char* hive_version(void) { return version(); }
int hive_abi_version(void) { return HIVE_ABI_VERSION; }
int hive_protocol_version(void) { return protocol_version(); }
