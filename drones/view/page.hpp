// The page for browsers. It loads nothing from other servers.
#pragma once

#include <string_view>

namespace view {

extern const std::string_view page_html, page_css, page_js;

}  // namespace view
