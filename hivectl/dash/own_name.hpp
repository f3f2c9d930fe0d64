// The names of the applications behind the page, by which it leaves itself out of what it shows.
#pragma once

#include <hive/application.hpp>

#include <string>
#include <vector>

namespace hivectl::dash {

/// "dash-PID-N", another one each time.
std::string own_name();
/// What outputs count for the pictures of this page is not shown.
void remove_own(std::vector<hive::StatusAnswer>& answers);

}  // namespace hivectl::dash
