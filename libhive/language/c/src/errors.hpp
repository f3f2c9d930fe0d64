// Between exceptions and codes: the last error of each thread, and what every function of the ABI runs in.
#pragma once

#include <hive.h>

#include <hive/error.hpp>

namespace hive::c {

hive_code code_of(Errc code) noexcept;
/// Errc::failed for what is no code of an error.
Errc errc_of(hive_code code) noexcept;

/// Makes it the last error of this thread. @return its code
hive_code keep(const Error& error) noexcept;
/// What is being handled in a catch clause becomes the last error.
hive_code keep_current() noexcept;
/// Throws what a callback that returned `code` means: its text, when it has left one by hive_fail() or by a call that
/// failed.
void require_done(hive_code code);
/// Before a callback: an old text must not be taken for its own.
void forget_error() noexcept;

/// Runs the body of a function of the ABI.
template <class Function>
hive_code guarded(Function&& function) noexcept
{
    try {
        function();
        return HIVE_OK;
    } catch (...) {
        return keep_current();
    }
}

/// Throws Errc::invalid_argument for null.
template <class Pointer>
Pointer* required(Pointer* pointer, const char* what)
{
    if (!pointer)
        throw Error(Errc::invalid_argument, std::string(what) + " is null");
    return pointer;
}

}  // namespace hive::c
