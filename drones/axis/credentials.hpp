// The user and password of an Axis camera, and the camera to which they belong.
#pragma once

#include "camera_url.hpp"

#include <login_file.hpp>

namespace axis {

using capture::Credentials;
using capture::written_at;

inline constexpr const char* user_variable = "HIVE_AXIS_USER";
inline constexpr const char* password_variable = "HIVE_AXIS_PASSWORD";

/// @param path  a file whose first line is user:password, and whose second line may be the URL of the camera that they
/// are for; empty: the environment variables above
/// @return  nothing if both are missing
/// @throws std::runtime_error  if the file is unreadable, invalid, or readable by others; when one
/// variable is missing
/// @throws std::invalid_argument  if the second line is not the URL of a camera
inline std::optional<Credentials> read_credentials(const std::string& path)
{
    auto credentials = capture::read_credentials(path, {user_variable, password_variable});
    if (credentials && !credentials->camera.empty())
        credentials->camera = parse_camera_url(credentials->camera).text();
    return credentials;
}

}  // namespace axis
