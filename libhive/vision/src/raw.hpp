// Pictures as plain pixels: what the header of image/raw declares, checked against the bytes that are there.
#pragma once

#include <hive/vision/image.hpp>

namespace hive::vision {

/// Read-only pixels over `body`, valid while the body lives; of bgra8 a copy without alpha. Throws Errc::malformed or
/// Errc::too_large.
cv::Mat raw_view(const Body& body, const Json& header, const DecodeLimits& limits);

/// The size that the header declares, after the same checks.
cv::Size raw_size(const Body& body, const Json& header, const DecodeLimits& limits);

}  // namespace hive::vision
