// The user and password of an Axis camera.
#pragma once

#include <login_file.hpp>

namespace axis {

using capture::Credentials;
using capture::written_at;

inline constexpr const char* user_variable = "HIVE_AXIS_USER";
inline constexpr const char* password_variable = "HIVE_AXIS_PASSWORD";

inline std::optional<Credentials> read_credentials(const std::string& path)
{
    return capture::read_credentials(path, {user_variable, password_variable});
}

}  // namespace axis
