// Ties the camera to the drone's parameters and output.
#pragma once

#include "camera_link.hpp"

#include <hive/drone.hpp>

#include <memory>
#include <string>

namespace axis {

/// On the user thread.
class AxisDrone {
public:
    explicit AxisDrone(hive::Drone& drone);
    void run() { drone_.run(); }

private:
    /// The settings of a link; a difference requires a new link.
    struct Place {
        std::string url, credentials, certificate, allow_address, pace;
        bool basic_over_http = false;
        bool operator==(const Place&) const = default;
    };

    void declare();
    void apply();
    void change();
    void open();
    void configure_camera(const Parameters& changed);
    [[nodiscard]] Access access() const;
    void require_own_login(const Access& access) const;
    [[nodiscard]] Parameters wanted() const;
    void take_over(const Parameters& applied);
    std::chrono::microseconds step();
    void send(const Frame& frame);
    void say(const std::string& condition, hive::LogLevel level = hive::LogLevel::info);

    hive::Drone& drone_;
    hive::Output image_;
    Place place_;
    std::string resolution_, exposure_;
    int compression_ = -1, fps_ = -1, brightness_ = -1, colour_ = -1;

    std::optional<Place> opened_;
    std::optional<Place> started_;  ///< the camera and login with which the drone was started
    Parameters applied_;            ///< the configuration that the link has for the camera
    bool refused_ = false;          ///< the camera refused the last change; the next one restores everything
    std::unique_ptr<CameraLink> link_;
    std::string condition_;
};

}  // namespace axis
