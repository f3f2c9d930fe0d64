// The status for the page.
#pragma once

#include "exchange.hpp"

#include <nlohmann/json.hpp>

namespace view {

/// {"sender","source","sequence","number","width","height","rate","age_ms","since_ms","browsers"}: since_ms is how long
/// ago the image came; age_ms how long ago it was captured. What is not known is null; rate is 0 when none came for
/// two seconds and twice as long as usual.
nlohmann::json status_of(const Exchange::Newest& newest, std::size_t browsers,
                         Exchange::Time now = std::chrono::steady_clock::now(),
                         std::chrono::system_clock::time_point wall = std::chrono::system_clock::now());

}  // namespace view
