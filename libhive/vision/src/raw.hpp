// Raw images: checks the declarations in the header of image/raw against the bytes of the body.
#pragma once

#include <hive/vision/image.hpp>

namespace hive::vision {

/// Read-only pixels over `body`, valid while the body lives; of bgra8 a copy without alpha. Throws Errc::malformed or
/// Errc::too_large.
cv::Mat raw_view(const Body& body, const Json& header, const DecodeLimits& limits);

/// The size that the header declares, after the same checks.
cv::Size raw_size(const Body& body, const Json& header, const DecodeLimits& limits);

}  // namespace hive::vision
