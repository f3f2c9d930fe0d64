// Converts raw pixels to a file that every viewer opens.
#pragma once

#include <hive/body.hpp>
#include <hive/json.hpp>

namespace hivectl {

/// The PNG of an image/raw of 8 bits per channel.
/// @throws Error  malformed: header and body do not match; unsupported: another pixel format
hive::Body png_of(const hive::Json& header, const hive::Body& pixels);

}  // namespace hivectl
