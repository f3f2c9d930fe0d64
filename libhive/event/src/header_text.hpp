// The header of an event as text, without a JSON value in between: each event has one, written once and read at every
// receiver.
#pragma once

#include <hive/event.hpp>
#include <hive/event/emission.hpp>

#include <string>
#include <string_view>

namespace hive::event {

inline constexpr std::size_t most_hops = 16;
inline constexpr int most_attempts = 1 << 20;  ///< that a share may tell
inline constexpr int most_part = 1 << 30;

/// Is it written as what a share is of: "camera.image", "camera.image#workers"?
[[nodiscard]] bool is_share_name(std::string_view text);

/// @param own  the share that the sender adds behind those of the event, or null
[[nodiscard]] std::string header_text(const Event& event, const Share* own);

/// Reads a header that is written as header_text writes: fields that it knows, each once, no white space between them
/// and nothing escaped in their strings (the author's own header may be anything). False for every other text, right or
/// wrong: then `event` is half filled and the reader of all JSON has to say what the text is.
[[nodiscard]] bool read_plain_header(std::string_view text, Event& event);

}  // namespace hive::event
