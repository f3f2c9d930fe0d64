// What an output of pictures declares, so that each connection gets them as it wants them.
#pragma once

#include <hive/encoder.hpp>

namespace hive::vision {

/// Knows `jpeg`, `png` and `raw`, and prefers `jpeg`. `jpeg` leaves a JPEG as it is and encodes the rest with quality
/// 80; `jpeg:Q` always has quality Q, 1 to 100, so it encodes a JPEG again. `png` and `raw` take no number. The header
/// of the result says "width" and "height", and for image/raw what raw_header() says. Pictures that view() refuses are
/// refused alike.
Encoder encoder();

}  // namespace hive::vision
