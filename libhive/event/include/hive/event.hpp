// An event as user code sees it: what happened, where and when it began, and its bytes.
#pragma once

#include <hive/body.hpp>
#include <hive/json.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace hive {

/// Time spent by one drone on the way of an event.
struct Hop {
    std::string drone;
    std::int64_t wait_us = 0;  ///< from arrival until its code began
    std::int64_t work_us = 0;  ///< from then until it emitted
};

/// Where and when an event began. Results inherit it, so boxes and picture can be matched, age can be measured, order
/// restored.
struct Identity {
    std::string source;             ///< the drone that captured
    std::int64_t epoch = 0;         ///< of the source: a restarted source has a larger one
    std::int64_t sequence = 0;      ///< of the capture, from 1, in that epoch
    std::int64_t captured_us = 0;   ///< wall clock, microseconds since 1970; 0: unknown
    std::int64_t monotonic_us = 0;  ///< the source machine's steady clock at the same moment; 0: unknown
    bool lossless = false;          ///< from a source that produces on demand: nobody on the way may skip it
    std::string group = {};         ///< shared work: the group that shares it; otherwise empty
    std::int64_t turn = 0;          ///< shared work: counts the events of the group, from 1 without gaps
    int attempt = 0;                ///< shared work: the number of this attempt, from 1
    int part = 0;                   ///< numbers the events that one drone emits on one output for one input, from 0
    std::vector<Hop> hops = {};
};

/// Cheap to copy: the body is shared.
struct Event {
    Identity identity;
    std::string sender;            ///< the drone that emitted it
    std::string kind;              ///< what that drone is: "face"
    std::string output;            ///< of the sender
    std::string input;             ///< where it arrived
    std::string type;              ///< media type of the body, "image/jpeg"
    Json header = Json::object();  ///< what the sender's author put in
    std::size_t size = 0;          ///< of the body at the sender, bytes
    std::chrono::steady_clock::time_point received{};
    /// While anybody holds it, the event counts as being worked on: the next one is asked for (and shared work
    /// acknowledged) when the last copy is gone.
    std::shared_ptr<const void> receipt;
    /// Empty in a notification. Declared last, so that it goes first: the memory is given back together with the
    /// receipt.
    Body body;

    /// Since the capture, by the wall clocks of the two machines; 0 when nobody knows when that was.
    [[nodiscard]] std::chrono::microseconds age() const;
};

}  // namespace hive
