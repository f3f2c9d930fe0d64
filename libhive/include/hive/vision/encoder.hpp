// The encoder of an image output: each connection chooses its encoding.
#pragma once

#include <hive/encoder.hpp>

namespace hive::vision {

/// Supports `jpeg` (the default), `png` and `raw`. `jpeg` leaves a JPEG unchanged and encodes other images with quality
/// 80; `jpeg:Q` always has quality Q, 1 to 100, so it encodes a JPEG again. `png` and `raw` have no number. The header
/// of the result has "width" and "height", and for image/raw the fields of raw_header(). Refuses the images that view()
/// refuses.
Encoder encoder();

}  // namespace hive::vision
