// The names of the applications behind the page, by which pages leave themselves out of what they show.
#pragma once

#include <hive/application.hpp>

#include <string>
#include <vector>

namespace hivectl::dash {

/// "dash-PID-N", another one each time.
std::string own_name();
/// What outputs count for the images of pages is not shown: of this one, of others, and of those that were killed.
void remove_pages(std::vector<hive::StatusAnswer>& answers);

}  // namespace hivectl::dash
