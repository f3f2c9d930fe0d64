// The user and password of the camera: from a file that only its owner can read, or from the environment.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace axis {

struct Credentials {
    std::string user, password;
    std::string camera = {};  ///< the URL of the camera that they are for; empty: the file does not say
    bool operator==(const Credentials&) const = default;
};

inline constexpr const char* user_variable = "HIVE_AXIS_USER";
inline constexpr const char* password_variable = "HIVE_AXIS_PASSWORD";

/// @param path  a file whose first line is user:password, and whose second line may be the URL of the camera that they
/// are for; empty: the environment variables above
/// @return  nothing when neither is there
/// @throws std::runtime_error  when the file cannot be read, is no such file, or others could read it too; when one
/// variable is missing
std::optional<Credentials> read_credentials(const std::string& path);
/// When the file was written; always the same time when there is none.
std::filesystem::file_time_type written_at(const std::string& path);

}  // namespace axis
