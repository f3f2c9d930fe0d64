// Passes on the file metadata of an image.
#pragma once

#include <hive/json.hpp>

namespace media_fields {

/// Copies the name of the file, its frame rate and the image's time in it, if present.
inline void pass_on(const hive::Json& from, hive::Json& to)
{
    for (const char* field : {"file", "fps", "media_time_us"})
        if (const auto told = from.find(field); told != from.end())
            to[field] = *told;
}

}  // namespace media_fields
