// Has Graphviz draw.
#pragma once

#include <string>

namespace hivectl {

/// The SVG that the program dot of Graphviz makes of a text in its language. Throws Errc::not_found without Graphviz,
/// Errc::timeout after 30 s, and Errc::failed.
std::string svg_of(const std::string& dot);

}  // namespace hivectl
