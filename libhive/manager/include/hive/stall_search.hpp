// Why nothing comes from some outputs.
#pragma once

#include <hive/application.hpp>

#include <functional>
#include <string>
#include <vector>

namespace hive {

/// What is stalled behind some outputs.
struct Stall {
    std::string text{};  ///< printable: "camera: image: waits for face.image to ask"; empty: all moves
    bool held = false;   ///< lossless results wait for a receiver of bodies
};

/// Asks the drones of the outputs, then those that they receive from, and so on up to the sources, each within the
/// timeout of the application.
/// @param words  text of the error of a drone that does not answer
Stall stall_behind(Application& application, const std::vector<Endpoint>& outputs,
                   const std::function<std::string(const Error&)>& words);

}  // namespace hive
