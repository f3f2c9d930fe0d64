// Encodes the events of an output for its receivers: raw pixels on one machine, a JPEG across a network.
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
    /// The encodings it supports. The first is used across a network unless a connection asks for another.
    std::vector<Encoding> encodings;
    /// Returns the event in that encoding ("jpeg:80"): its type, its body, and what the header says of the body. If it
    /// throws, the error is reported as an exception of the drone and the event is sent unencoded. Called on the
    /// encoder thread.
    std::function<Event(const Event& event, const std::string& encoding)> encode;
};

}  // namespace hive
