// How an output gives its events in other encodings: pixels as they are on one machine, a JPEG across a network.
#pragma once

#include <hive/encoding.hpp>
#include <hive/event.hpp>

#include <functional>
#include <string>
#include <vector>

namespace hive {

/// Declared with an output. Without an encoder (default-constructed) every receiver gets the events as they were
/// emitted.
struct Encoder {
    /// Those that it knows, the preferred one first: that is what travels across a network unless a connection asks for
    /// another.
    std::vector<Encoding> encodings;
    /// The same event in that encoding ("jpeg:80"): its type, its body, and what the header says of the body. What it
    /// throws is reported as an exception of the drone, and the event travels as it was emitted. On a thread of its
    /// own.
    std::function<Event(const Event& event, const std::string& encoding)> encode;
};

}  // namespace hive
