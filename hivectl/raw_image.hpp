// Raw pixels as a file that every viewer opens.
#pragma once

#include <hive/body.hpp>
#include <hive/json.hpp>

namespace hivectl {

/// The PNG of an image/raw of 8 bits per channel.
/// @throws Error  malformed: header and body do not fit; unsupported: pixels of another format
hive::Body png_of(const hive::Json& header, const hive::Body& pixels);

}  // namespace hivectl
