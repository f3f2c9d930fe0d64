// Texts that came from elsewhere, before they are kept or shown: short, and without orders to a terminal.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace hive {

/// What is kept of a text that a peer, a camera or an exception brings: errors, conditions, lines of a log.
inline constexpr std::size_t longest_text = 4000;
/// At most so many bytes, the end replaced by "…"; no character is cut in two. At least 3.
std::string shortened(std::string_view text, std::size_t most = longest_text);

/// The text with control characters, line ends, bidirectional overrides and bytes that are not UTF-8 written as
/// escapes.
std::string printable(std::string_view text);

/// What stands in the place of such a character. @param c  -1: bytes that are not UTF-8
using Escape = std::function<std::string(std::int32_t c, std::string_view bytes)>;
std::string escaped(std::string_view text, const Escape& escape);

}  // namespace hive
