// The drone's side of a network camera, opened by a test.
#pragma once

#include "hostile_camera.hpp"
#include "hostile_media.hpp"
#include "video_source.hpp"

#include <exception>
#include <string>

namespace network {

using camera::open_url;
using camera::UrlLimits;
using camera::UrlSettings;
using hostile::Camera;
using hostile::Client;

inline constexpr std::size_t mebibyte = 1 << 20;

/// Why the camera is refused, at the latest with its third image; empty: it is not.
inline std::string told_by(const UrlSettings& settings)
{
    try {
        const auto source = open_url(settings, nullptr);
        for (int i = 0; i < 3 && source->next(); ++i) {
        }
    } catch (const std::exception& problem) {
        return problem.what();
    }
    return "";
}

inline UrlSettings settings_of(const std::string& url, UrlLimits limits = {})
{
    UrlSettings settings;
    settings.url = url;
    settings.limits = limits;
    return settings;
}

inline std::string told_by(const std::string& url, UrlLimits limits = {}) { return told_by(settings_of(url, limits)); }

inline bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Answers every request with the same bytes.
inline Camera::Answer always(const std::string& bytes)
{
    return [bytes](Client& client, const std::string&) {
        client.send(bytes);
        return false;
    };
}

inline std::string redirection(const std::string& to)
{
    return "HTTP/1.1 302 Found\r\nLocation: " + to + "\r\nContent-Length: 0\r\n\r\n";
}

}  // namespace network
