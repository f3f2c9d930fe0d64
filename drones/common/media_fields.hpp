// Passes on the file metadata of an image.
#pragma once

#include <hive/json.hpp>

namespace media_fields {

/// Copies the name of the file, its frame rate and the image's time in it, if present.
inline void pass_on(const hive::Json& from, hive::Json& to)
{
    for (const char* field : {"file", "fps", "media_time_us"})
        if (const auto found = from.find(field); found != from.end())
            to[field] = *found;
}

}  // namespace media_fields
