// Reads back what the recorder has recorded.
#pragma once

#include "numbering.hpp"
#include "received.hpp"

#include <filesystem>

namespace hive::mixtures {

/// All recordings of a folder, which must be complete.
Received recorded_in(const std::filesystem::path& folder, const Numbering& numbering);

}  // namespace hive::mixtures
