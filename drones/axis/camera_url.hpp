// The URL of a camera: scheme, host and port alone, without secrets.
#pragma once

#include <shown_url.hpp>

#include <string>
#include <utility>

namespace axis {

struct CameraUrl {
    std::string scheme;  ///< http or https
    std::string host;    ///< a name, an IPv4 address, or an IPv6 address in brackets
    int port = 0;        ///< 0: the default of the scheme

    [[nodiscard]] bool encrypted() const { return scheme == "https"; }
    /// scheme://host or scheme://host:port
    [[nodiscard]] std::string text() const;
    bool operator==(const CameraUrl&) const = default;
};

/// @throws std::invalid_argument  with the reason, but without a password in the URL
CameraUrl parse_camera_url(const std::string& text);

/// Redacts a remote text for the log: hides the part between :// and @, and removes the part after ? and the end of
/// long texts.
inline std::string masked(std::string text) { return capture::shown_url(std::move(text)); }

}  // namespace axis
