// Writes streams of images in every variant that cameras and broken cameras have.
#pragma once

#include "behaviour.hpp"

#include <string>

namespace axis::emulator {

/// The Content-Type of the stream.
std::string stream_type(const Behaviour& behaviour);

/// One part: boundary, head, image and what follows it.
std::string stream_part(const Behaviour& behaviour, const std::string& jpeg);

}  // namespace axis::emulator
