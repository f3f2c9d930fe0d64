// Asks an Axis camera over VAPIX for its model, its parameters, single pictures and its stream.
#pragma once

#include "http.hpp"
#include "multipart.hpp"
#include "parameter_text.hpp"

#include <functional>
#include <string>

namespace axis {

/// What the camera says it is; empty fields where it does not tell.
struct Model {
    std::string name, firmware, serial;
};

/// For one thread at a time. Every function throws CameraError and ends within its time: 4 s, a stream when it is
/// silent for 2 s.
class Camera {
public:
    /// @param time  called ten times a second while waiting; may throw, to end it
    explicit Camera(
        const Access& access, std::function<void()> time = [] {});

    /// @throws CameraError  not_vapix, if it is something else
    Model identify();
    /// The present values of these parameters; those it does not have are missing.
    Parameters list(const Parameters& names);
    /// Makes the camera's parameters so, all or none: what it has already is not written again (its flash memory wears
    /// out). Returns what it says to have afterwards.
    /// @throws CameraError  setting_refused, with the camera's reason
    Parameters apply(const Parameters& wanted);
    /// One picture, not checked.
    std::string snapshot();
    /// Gives the parts of the stream until it ends, which is Trouble::closed.
    void stream(const std::function<void(Part)>& take);

private:
    std::string parameters(const std::string& query);
    void update(const Parameters& values);

    Http http_;
    std::function<void()> time_;
    bool admin_path_ = false;  ///< old firmware: updates go to /axis-cgi/admin/
};

}  // namespace axis
