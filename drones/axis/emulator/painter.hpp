// Makes the images of the emulated camera: the synthetic scene, with the settings of its parameters.
#pragma once

#include "parameter_store.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace camera {
class Scene;
}

namespace axis::emulator {

class Painter {
public:
    Painter();
    ~Painter();

    /// A JPEG. @param resolution  WIDTHxHEIGHT, one that the store has. @param compression  0 to 100, more is smaller
    std::string jpeg(const ParameterStore& parameters, const std::string& resolution, int compression,
                     std::int64_t index);

private:
    std::map<std::string, std::unique_ptr<camera::Scene>> scenes_;  ///< by resolution
};

}  // namespace axis::emulator
