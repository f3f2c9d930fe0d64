// MD5 (RFC 1321): what digest authentication is made of, for a server that only tests clients.
#pragma once

#include <string>
#include <string_view>

namespace axis::emulator {

/// 32 lower-case hexadecimal digits.
std::string md5(std::string_view text);

}  // namespace axis::emulator
