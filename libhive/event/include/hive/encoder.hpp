// How an output gives its events in other encodings: pixels as they are on one machine, a JPEG across a network.
#pragma once

#include <hive/event.hpp>

#include <functional>
#include <string>
#include <vector>

namespace hive {

/// Declared with an output. An encoding is a word, with a number if wanted ("raw", "jpeg:80"; see is_encoding). Without
/// an encoder (default-constructed) every receiver gets the events as they were emitted.
struct Encoder {
    /// The words it knows, the preferred one first: that is what travels across a network unless a connection asks for
    /// another.
    std::vector<std::string> encodings;
    /// The media type that an encoding gives. Throws Errc::invalid_argument naming what there is. Any thread.
    std::function<std::string(const std::string& encoding)> type;
    /// The same event in that encoding: its type, its body, and what the header says of the body. What it throws is
    /// reported as an exception of the drone, and the event travels as it was emitted. On a thread of its own.
    std::function<Event(const Event& event, const std::string& encoding)> encode;

    explicit operator bool() const noexcept { return !encodings.empty(); }
};

}  // namespace hive
