// URLs for display: without logins, queries and control characters.
#pragma once

#include <string>

namespace capture {

/// @return  at most 203 printable characters, "http://***@host/path" for "http://user:password@host/path?query"
std::string shown_url(std::string text);

}  // namespace capture
