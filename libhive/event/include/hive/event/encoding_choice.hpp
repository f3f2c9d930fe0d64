// Which encoding one receiver gets: what its connection asked for, or what suits the way to it and what it takes.
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

    /// The encoding for this event; empty: as it is.
    std::string of(const Event& event);
    static constexpr const char* as_it_is = "as it is";
    /// For people: "jpeg:80", or the above.
    [[nodiscard]] std::string word() const;

private:
    /// The preferred encoding that the receiver takes, or empty.
    [[nodiscard]] std::string preferred() const;
    [[nodiscard]] bool met_by(const Event& event, const std::string& encoding) const;

    const Port& output_;
    std::string accepts_;
    std::string always_;      ///< whatever the event is
    bool fell_back_ = false;  ///< the last event had to be encoded because the receiver does not take it as it is
};

}  // namespace hive::event
