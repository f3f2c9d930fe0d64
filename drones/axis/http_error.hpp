// Explains unsuccessful HTTP answers and failed transfers.
#pragma once

#include "http.hpp"

namespace axis {

/// @param head  its status is not 200
CameraError error_of_status(const Access& access, const Head& head);

/// @param code     of libcurl, a CURLcode that is not CURLE_OK
/// @param problem  the last error of the operating system, an errno or 0
CameraError error_of_transfer(const Access& access, const Limits& limits, int code, long problem);

}  // namespace axis
