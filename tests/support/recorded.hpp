// The number of events in a recording that is still being written.
#pragma once

#include <hive/recording/reader.hpp>

#include <exception>

namespace hive::test {

/// 0 also if there is no file, or its start is not yet written.
inline std::int64_t recorded_in(const std::filesystem::path& file)
try {
    return recording::Reader(file).summary().events();
} catch (const std::exception&) {
    return 0;
}

}  // namespace hive::test
