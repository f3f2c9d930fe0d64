// Reading the golden vectors (protocol/vectors/README.md).
#pragma once

#include <hive/error.hpp>
#include <hive/json.hpp>

#include <doctest/doctest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hive::wire {

/// A file of protocol/, whole.
std::string read_file(const std::string& name);

/// The rows of a vector file; requires at least `least` of them, so that a lost file cannot pass.
std::vector<Json> read_vectors(const std::string& name, std::size_t least);

std::string from_hex(std::string_view hex);
std::string to_hex(std::string_view bytes);

/// The input of a row: "text", "hex", or "parts" repeated. Parts are hex for packets, text for the rest.
std::string input_of(const Json& row, bool parts_are_hex = false);

/// The code of the error that `action` throws, or nothing.
std::optional<Errc> error_of(const std::function<void()>& action);

/// Checks the outcome against "error" of the row, or against success when it has none.
void check_outcome(const Json& row, std::optional<Errc> error);

}  // namespace hive::wire
