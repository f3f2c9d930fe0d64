// One run of one row's program, and what it printed.
#pragma once

#include "plan.hpp"

#include <hive/json.hpp>

#include <filesystem>
#include <optional>

namespace hive::bench {

/// Where this program is, and so the rows' programs.
std::filesystem::path programs();
/// Is the program of the row built here?
bool present(const Row& row);
/// The run of a row in a column.
Run run_of(const Row& row, const Column& column);
/// Runs it, by a deadline; what it says on stderr is said here. Nothing when it printed no JSON.
std::optional<Json> execute(const Run& run);

}  // namespace hive::bench
