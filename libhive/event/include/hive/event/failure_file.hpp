// A kept failure as a file: packets as on the wire, one about the failure and its drone, then one for each input.
#pragma once

#include <hive/kept_failure.hpp>

#include <cstdint>
#include <filesystem>
#include <iosfwd>

namespace hive::event {

/// Of all bodies of a failure, and of a file with its headers.
constexpr std::uintmax_t max_failure_bytes = 64u << 20;
constexpr std::uintmax_t max_failure_file_bytes = max_failure_bytes + (2u << 20);

/// An upper bound of the size of its file.
[[nodiscard]] std::uintmax_t failure_file_bound(const KeptFailure& failure);
/// Does not check whether the stream has failed. @throws Error  too_large: the parameters of its drone
void write_failure(std::ostream& out, const KeptFailure& failure);
/// Trusts no size in the file: nothing larger than the file itself is allocated.
/// @param bodies  false: the events have only their headers and sizes
/// @return        without `number` and `run`, which are the store's
/// @throws Error  io; malformed: not such a file, or truncated; version_mismatch: of another protocol; too_large
[[nodiscard]] KeptFailure read_failure(const std::filesystem::path& file, bool bodies);

}  // namespace hive::event
