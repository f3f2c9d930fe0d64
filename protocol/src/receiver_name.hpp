// The field `receiver` of a request: a drone, or an input of it.
#pragma once

#include <hive/json.hpp>
#include <hive/name.hpp>

#include <string>

namespace hive::protocol {

/// "face" or "face.image": displayed, and used as a name in tables.
inline std::string receiver_name(const Fields& fields, const std::string& message)
{
    auto text = fields.text("receiver");
    const auto dot = text.rfind('.');
    const bool both = dot != std::string::npos && is_name(text.substr(0, dot)) && is_name(text.substr(dot + 1));
    if (!both && !is_name(text))
        throw Error(Errc::malformed, message + ": \"receiver\" must be a name, or two joined by a point");
    return text;
}

}  // namespace hive::protocol
