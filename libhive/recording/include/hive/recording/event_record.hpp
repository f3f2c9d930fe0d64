// Converts events to records and back, for drones and hivectl.
#pragma once

#include <hive/event_text.hpp>
#include <hive/recording/reader.hpp>
#include <hive/recording/writer.hpp>

namespace hive::recording {

/// The header to record. It omits how the event was shared and acknowledged, so recordings of the same events have the
/// same bytes.
inline std::string kept_text(const hive::Event& event)
{
    if (event.identity.shares.empty())
        return hive::event_text(event);
    hive::Event plain = event;
    plain.identity.shares.clear();
    return hive::event_text(plain);
}

/// @return false when the recording has ended
inline bool append(Writer& writer, const hive::Event& event)
{
    // Another process could still change shared bytes, and they would no longer match their check sum.
    const auto bytes = event.body.bytes();
    const std::vector<std::byte> copy(event.body.foreign() ? std::vector<std::byte>(bytes.begin(), bytes.end())
                                                           : std::vector<std::byte>());
    const bool has_body = !bytes.empty() || (event.sized && event.size == 0);
    return writer.append({event.sender, event.output, event.type}, kept_text(event),
                         copy.empty() ? bytes : std::span<const std::byte>(copy), has_body, event.received);
}

}  // namespace hive::recording
