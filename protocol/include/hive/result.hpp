// The result of an operation: a value or an error.
#pragma once

#include <hive/error.hpp>

#include <utility>
#include <variant>

namespace hive {

template <class T>
using Result = std::variant<T, Error>;

/// Nothing if there is a value.
template <class T>
const Error* error_of(const Result<T>& result)
{
    return std::get_if<Error>(&result);
}

/// Nothing if there is an error.
template <class T>
const T* value_of(const Result<T>& result)
{
    return std::get_if<T>(&result);
}

/// Throws the error if there is no value.
template <class T>
const T& value_or_throw(const Result<T>& result)
{
    if (const auto* error = error_of(result))
        throw *error;
    return std::get<T>(result);
}

/// An empty value, or a null pointer, for an error.
template <class T>
T value_or_none(Result<T> result)
{
    auto* const value = std::get_if<T>(&result);
    return value ? std::move(*value) : T{};
}

}  // namespace hive
