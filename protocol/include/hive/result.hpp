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

/// The pointer, or null for an error.
template <class T>
T value_or_none(Result<T> result)
{
    auto* const value = std::get_if<T>(&result);
    return value ? std::move(*value) : T{};
}

}  // namespace hive
