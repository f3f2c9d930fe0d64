// A failure as programs tell it each other: one line, {"error": {"code", "text", "advice", "drone"}}.
#pragma once

#include <hive/error.hpp>
#include <hive/json.hpp>

#include <optional>
#include <string>

namespace hive {

/// @param drone  that has failed, or its port; empty: the failure is of none
Json failure_json(const Error& error, const std::string& drone = {});
/// The last failure among the lines that a program printed; nothing when there is none.
std::optional<Error> failure_in(const std::string& printed);

}  // namespace hive
