// A failure as programs print it for each other: one line, {"error": {"code", "text", "advice", "drone"}}.
#pragma once

#include <hive/error.hpp>
#include <hive/json.hpp>

#include <optional>
#include <string>

namespace hive {

/// @param drone  that failed, or its port; empty: the failure concerns none
Json failure_json(const Error& error, const std::string& drone = {});
/// The last failure in a program's output; nothing if there is none.
std::optional<Error> failure_in(const std::string& printed);

}  // namespace hive
