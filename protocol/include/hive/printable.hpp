// Shortens texts from outside before they are kept, and escapes terminal control sequences before they are shown.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace hive {

/// Maximum length of a text from a peer, a camera or an exception: errors, conditions, log lines.
inline constexpr std::size_t longest_text = 4000;
/// At most `most` bytes, the end replaced by "…"; no character is cut in two. `most` is at least 3.
std::string shortened(std::string_view text, std::size_t most = longest_text);

/// The text with control characters, line ends, bidirectional overrides and bytes that are not UTF-8 written as
/// escapes.
std::string printable(std::string_view text);

/// The replacement for such a character. @param c  -1: bytes that are not UTF-8
using Escape = std::function<std::string(std::int32_t c, std::string_view bytes)>;
std::string escaped(std::string_view text, const Escape& escape);

}  // namespace hive
