// The kinds of failure between the drone and the camera, each with a sentence for people.
#pragma once

#include <stdexcept>
#include <string>

namespace axis {

enum class Trouble {
    not_allowed,      ///< the host is at an address that nobody has allowed
    unknown_host,     ///< its name cannot be resolved
    no_route,         ///< the network says that there is no way
    refused,          ///< nobody listens there
    no_answer,        ///< no connection within its time
    silent,           ///< connected, but no byte within its time
    closed,           ///< it closed the connection
    insecure,         ///< no encrypted connection could be made
    not_vapix,        ///< what answers is not an Axis camera
    not_a_picture,    ///< something else came instead of pictures
    too_large,        ///< an answer over its limit
    redirected,       ///< it points elsewhere, where nobody goes
    login_needed,     ///< it wants a user and a password, and there are none that may be sent
    login_refused,    ///< it does not take the user and the password
    refused_status,   ///< any other answer that is no success
    setting_refused,  ///< it does not take a value
    cancelled         ///< nobody wants the answer any more
};

class CameraError : public std::runtime_error {
public:
    CameraError(Trouble trouble, const std::string& text) : std::runtime_error(text), trouble_(trouble) {}
    [[nodiscard]] Trouble trouble() const noexcept { return trouble_; }

private:
    Trouble trouble_;
};

}  // namespace axis
