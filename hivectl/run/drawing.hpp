// Runs Graphviz.
#pragma once

#include <string>

namespace hivectl {

/// The SVG that `dot` renders from a text in the DOT language. Throws Errc::not_found without Graphviz, Errc::timeout
/// after 30 s, and Errc::failed.
std::string svg_of(const std::string& dot);

}  // namespace hivectl
