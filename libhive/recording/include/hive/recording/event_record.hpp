// Between events and recordings: what of an event is kept, and how it comes back. For the drones and hivectl alike.
#pragma once

#include <hive/event_text.hpp>
#include <hive/recording/reader.hpp>
#include <hive/recording/writer.hpp>

namespace hive::recording {

/// The header that is kept. Who shared or owed the event on its way is no part of it: a recording of the same events
/// has the same bytes.
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
    // What another process could still change would not fit its check sum.
    const auto bytes = event.body.bytes();
    const std::vector<std::byte> copy(event.body.foreign() ? std::vector<std::byte>(bytes.begin(), bytes.end())
                                                           : std::vector<std::byte>());
    const bool has_body = !bytes.empty() || (event.sized && event.size == 0);
    return writer.append({event.sender, event.output, event.type}, kept_text(event),
                         copy.empty() ? bytes : std::span<const std::byte>(copy), has_body, event.received);
}

}  // namespace hive::recording
