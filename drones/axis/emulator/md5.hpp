// MD5 (RFC 1321), which digest authentication needs. Only a server that tests clients may still use it.
#pragma once

#include <string>
#include <string_view>

namespace axis::emulator {

/// 32 lower-case hexadecimal digits.
std::string md5(std::string_view text);

}  // namespace axis::emulator
