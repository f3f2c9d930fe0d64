// The kinds of failure between the drone and the camera, each with a sentence for people.
#pragma once

#include <stdexcept>
#include <string>

namespace axis {

enum class Failure {
    not_allowed,      ///< the address of the host is not allowed
    unknown_host,     ///< its name cannot be resolved
    no_route,         ///< no route to the network
    refused,          ///< no listener there
    no_answer,        ///< no connection within its time
    silent,           ///< connected, but no byte within its time
    closed,           ///< the camera closed the connection
    insecure,         ///< no encrypted connection could be made
    not_vapix,        ///< what answers is not an Axis camera
    not_an_image,     ///< the answer is not an image
    too_large,        ///< an answer over its limit
    redirected,       ///< a redirection, which is not followed
    login_needed,     ///< login required, and none may be sent
    login_refused,    ///< user or password refused
    refused_status,   ///< any other unsuccessful answer
    setting_refused,  ///< value refused
    cancelled         ///< the answer is no longer needed
};

class CameraError : public std::runtime_error {
public:
    CameraError(Failure kind, const std::string& text) : std::runtime_error(text), kind_(kind) {}
    [[nodiscard]] Failure kind() const noexcept { return kind_; }

private:
    Failure kind_;
};

}  // namespace axis
