// The encoding for one receiver: the one its connection asked for, or the one that suits the path to it and the types
// it accepts.
#pragma once

#include <hive/interface.hpp>
#include <hive/protocol/messages.hpp>

#include <string>

namespace hive::event {

/// Decided when the receiver registers, and refined by each event. Pure logic, for one thread.
class EncodingChoice {
public:
    enum class Way { one_machine, network };

    /// Throws what require_encoding() throws.
    /// @param output  kept by reference
    EncodingChoice(const Port& output, const protocol::Registration& registration, Way way);

    /// The encoding for this event; empty: unencoded.
    std::string of(const Event& event);
    static constexpr const char* as_it_is = "as it is";
    /// As readable text: "jpeg:80", or the above.
    [[nodiscard]] std::string word() const;

private:
    /// The preferred encoding that the receiver accepts, or empty.
    [[nodiscard]] std::string preferred() const;
    [[nodiscard]] bool met_by(const Event& event, const std::string& encoding) const;

    const Port& output_;
    std::string accepts_;
    std::string always_;      ///< whatever the event is
    bool fell_back_ = false;  ///< the last event had to be encoded because the receiver does not accept its type
};

}  // namespace hive::event
