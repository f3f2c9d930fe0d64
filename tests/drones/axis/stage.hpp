// The emulated camera as a process, and a drone connected to it.
#pragma once

#include "camera.hpp"

#include <swarm.hpp>

#include <string>
#include <vector>

namespace stage {

using namespace hive::test;

inline const std::vector<std::string> emulator{"/usr/bin/python3", HIVE_SOURCE_DIR "/tests/support/axis_camera.py"};

class EmulatedCamera {
public:
    explicit EmulatedCamera(const Swarm& swarm, std::vector<std::string> words = {});

    [[nodiscard]] std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }
    /// Changes its behaviour: "stall=on&fps=5".
    void behave(const std::string& words) const;
    /// One of its counts: connections, wrong_logins, updates, images.
    [[nodiscard]] int count(const std::string& what) const;
    /// The answer of param.cgi, for a camera without a login.
    [[nodiscard]] std::string parameter(const std::string& name) const;

private:
    std::string control(const std::string& words) const;

    std::filesystem::path log_;
    Process process_;
    int port_ = 0, control_port_ = 0;
};

/// A file of credentials, with the mode that is asked of one.
std::string credentials_file(const Swarm& swarm, const std::string& line);

/// A drone named axis with the URL of the camera.
Process axis_drone(const Swarm& swarm, const EmulatedCamera& camera, std::vector<std::string> settings = {},
                   const std::vector<std::string>& environment = {});

std::string condition(hive::Application& application);
/// Waits for a condition with this start.
bool comes_to_say(hive::Application& application, const std::string& beginning,
                  Milliseconds timeout = Milliseconds(6000));

/// As above, while the images are taken that come, each decoded strictly.
bool comes_to_say(hive::Application& application, hive::Collector& collector, const std::string& beginning,
                  Milliseconds timeout);

/// Takes `count` images that were captured from now on and decodes each, strictly: throws when one is broken or does
/// not come.
void take_images(hive::Collector& collector, int count, Milliseconds timeout = Milliseconds(5000));

}  // namespace stage
