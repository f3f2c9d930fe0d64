// The URL of a camera: scheme, host and port alone, without secrets.
#pragma once

#include <shown_url.hpp>

#include <string>
#include <utility>

namespace axis {

struct CameraUrl {
    std::string scheme;  ///< http or https
    std::string host;    ///< a name, an IPv4 address, or an IPv6 address in brackets
    int port = 0;        ///< 0: as the scheme has it

    [[nodiscard]] bool encrypted() const { return scheme == "https"; }
    /// scheme://host or scheme://host:port
    [[nodiscard]] std::string text() const;
    bool operator==(const CameraUrl&) const = default;
};

/// @throws std::invalid_argument  saying what is wrong; a password in the URL is not repeated
CameraUrl parse_camera_url(const std::string& text);

/// A text from elsewhere as it may be logged: what stands between :// and @ is hidden, what follows ? is left out, and
/// of long texts the end.
inline std::string masked(std::string text) { return capture::shown_url(std::move(text)); }

}  // namespace axis
