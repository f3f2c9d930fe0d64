// The status for the page.
#pragma once

#include "exchange.hpp"

#include <nlohmann/json.hpp>

namespace view {

/// {"sender","source","sequence","number","width","height","rate","age_ms","since_ms","browsers"}: since_ms is the time
/// since its arrival, age_ms since its capture. Unknown values are null; rate is 0 after two seconds and twice the
/// usual interval without an image.
nlohmann::json status_of(const Exchange::Newest& newest, std::size_t browsers,
                         Exchange::Time now = std::chrono::steady_clock::now(),
                         std::chrono::system_clock::time_point wall = std::chrono::system_clock::now());

}  // namespace view
