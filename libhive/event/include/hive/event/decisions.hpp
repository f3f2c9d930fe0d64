// What the logic of an output decides, for the outlet to carry out.
#pragma once

#include <hive/event/emission.hpp>

#include <optional>
#include <vector>

namespace hive::event {

using ReceiverId = std::uint64_t;

/// A decision: give this event to this receiver.
struct Send {
    ReceiverId receiver;
    EmissionPtr event;
    Delivery delivery;
    std::optional<Share> share;  ///< what it is told of whose work this is, where that is not the same for all
};
/// What a receiver had in hand when it died or when its lease expired.
struct FailedAt {
    ReceiverId receiver;
    EmissionPtr event;
    bool
        worked;  ///< it said that it had finished with it, but not acknowledged it: it may have kept it for its partner
};
/// What a call decided: what to send now, and which events are given up.
struct Decisions {
    std::vector<Send> sends;
    std::vector<EmissionPtr> failed;  ///< with the share of the last attempt, if there was one
    std::vector<FailedAt> failed_at;  ///< what may be to blame for the end of a receiver
    std::vector<ReceiverId> ends;     ///< who is to hear, behind what is sent, that nothing more will come
    std::vector<ReceiverId> revoked;  ///< who is to hear, before what is sent, that this no longer holds
};

}  // namespace hive::event
