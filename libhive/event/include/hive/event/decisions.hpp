// The decisions of the logic of an output, carried out by the outlet.
#pragma once

#include <hive/event/emission.hpp>

#include <optional>
#include <vector>

namespace hive::event {

using ReceiverId = std::uint64_t;

/// Sends this event to this receiver.
struct Send {
    ReceiverId receiver;
    EmissionPtr event;
    Delivery delivery;
    std::optional<Share> share;  ///< the receiver's share, if it differs between receivers
};
/// The events in progress at a receiver when it crashed or its lease expired.
struct FailedAt {
    ReceiverId receiver;
    EmissionPtr event;
    bool
        worked;  ///< it said that it had finished with it, but not acknowledged it: it may have kept it for its partner
};
/// The decisions of one call.
struct Decisions {
    std::vector<Send> sends;
    std::vector<EmissionPtr> failed;  ///< given up; with the share of the last attempt, if any
    std::vector<FailedAt> failed_at;  ///< events that may have crashed a receiver
    std::vector<ReceiverId> ends;     ///< receivers that get the end, after the events sent
    std::vector<ReceiverId> revoked;  ///< receivers whose end is revoked, before the events sent
};

}  // namespace hive::event
