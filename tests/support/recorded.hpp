// How much a recording has that is still being written.
#pragma once

#include <hive/recording/reader.hpp>

#include <exception>

namespace hive::test {

/// So many events; 0 as well when there is no file, or its beginning is still to be written.
inline std::int64_t recorded_in(const std::filesystem::path& file)
try {
    return recording::Reader(file).summary().events();
} catch (const std::exception&) {
    return 0;
}

}  // namespace hive::test
