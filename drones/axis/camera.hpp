// Queries an Axis camera over VAPIX for its model, parameters, single images and stream.
#pragma once

#include "http.hpp"
#include "multipart.hpp"
#include "parameter_text.hpp"

#include <functional>
#include <string>

namespace axis {

/// The camera's model; empty fields if not reported.
struct Model {
    std::string name, firmware, serial;
};

/// For one thread at a time. Every function throws CameraError and returns within 4 s, a stream after 2 s without data.
class Camera {
public:
    /// @param time  called ten times a second while waiting; may throw to cancel
    explicit Camera(
        const Access& access, std::function<void()> time = [] {});

    /// @throws CameraError  not_vapix, if it is something else
    Model identify();
    /// The current values of these parameters; unknown ones are missing.
    Parameters list(const Parameters& names);
    /// Sets the camera's parameters, all or none. Equal values are not written again (flash memory wears out). Returns
    /// the values that the camera reports afterwards.
    /// @throws CameraError  setting_refused, with the camera's reason
    Parameters apply(const Parameters& wanted);
    /// One image, not checked.
    std::string snapshot();
    /// Passes on the parts of the stream until it ends, with Failure::closed.
    void stream(const std::function<void(Part)>& take);

private:
    std::string parameters(const std::string& query);
    void update(const Parameters& values);

    Http http_;
    std::function<void()> time_;
    bool admin_path_ = false;  ///< old firmware: updates go to /axis-cgi/admin/
};

}  // namespace axis
