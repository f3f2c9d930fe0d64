// What a picture from a file says of itself, for those who make something of it to pass on.
#pragma once

#include <hive/json.hpp>

namespace media_fields {

/// Copies the name of the file and the picture's time in it, where they are told.
inline void pass_on(const hive::Json& from, hive::Json& to)
{
    for (const char* field : {"file", "media_time_us"})
        if (const auto told = from.find(field); told != from.end())
            to[field] = *told;
}

}  // namespace media_fields
