// Converts between exceptions and codes: the last error of each thread, and the wrapper of every ABI function.
#pragma once

#include <hive.h>

#include <hive/error.hpp>

namespace hive::c {

hive_code code_of(Errc code) noexcept;
/// Errc::failed for an unknown code.
Errc errc_of(hive_code code) noexcept;

/// Makes it the last error of this thread. @return its code
hive_code keep(const Error& error) noexcept;
/// Makes the exception of the current catch clause the last error.
hive_code keep_current() noexcept;
/// Throws the error of a callback that returned `code`, with the text that it left by hive_fail() or a failed call, if
/// any.
void require_done(hive_code code);
/// Before a callback: clears an old text, so that it is not mistaken for the callback's.
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
