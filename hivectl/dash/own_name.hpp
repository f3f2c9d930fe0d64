// The names of the page's applications, by which pages hide themselves.
#pragma once

#include <hive/application.hpp>

#include <string>
#include <vector>

namespace hivectl::dash {

/// "dash-PID-N", unique per call.
std::string own_name();
/// Hides the connections for the images of pages: this one, others, and killed ones.
void remove_pages(std::vector<hive::StatusAnswer>& answers);

}  // namespace hivectl::dash
