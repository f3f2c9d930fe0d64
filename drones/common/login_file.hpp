// The user and password of a camera: from a file that only its owner can read, or from the environment.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace capture {

struct Credentials {
    std::string user, password;
    std::string camera = {};  ///< the URL of the camera that they are for; empty: the file does not say
    bool operator==(const Credentials&) const = default;
};

/// Names of variables of the environment.
struct CredentialVariables {
    const char* user;
    const char* password;
};

/// @param path  a file whose first line is user:password, and whose second line may be a URL; empty: the environment
/// variables
/// @return  nothing if both are missing
/// @throws std::runtime_error  if the file is unreadable, invalid, or readable by others; when one
/// variable is missing
std::optional<Credentials> read_credentials(const std::string& path, const CredentialVariables& variables);
/// When the file was written; a constant time without a file.
std::filesystem::file_time_type written_at(const std::string& path);

}  // namespace capture
