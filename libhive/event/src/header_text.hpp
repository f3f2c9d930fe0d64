// Writes and reads the header of an event without a JSON value in between, since each event has one, written once and
// read at every receiver.
#pragma once

#include <hive/event.hpp>
#include <hive/event/emission.hpp>

#include <string>
#include <string_view>

namespace hive::event {

inline constexpr std::size_t most_hops = 16;
inline constexpr int most_attempts = 1 << 20;  ///< that a share may have
inline constexpr int most_part = 1 << 30;

/// Has the text the form of a share's `of`: "camera.image", "camera.image#workers"?
[[nodiscard]] bool is_share_name(std::string_view text);

/// @param own  the share that the sender appends to those of the event, or null
[[nodiscard]] std::string header_text(const Event& event, const Share* own);

/// Reads a header in the form of header_text: known fields, each once, without white space between them and without
/// escapes in their strings (the author's header may be anything). False for every other text, valid or not: then
/// `event` is partly filled, and the full JSON parser must read the text.
[[nodiscard]] bool read_plain_header(std::string_view text, Event& event);

}  // namespace hive::event
