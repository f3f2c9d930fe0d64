// Which encoding one receiver gets: what its connection asked for, or what suits the way to it and what it takes.
#pragma once

#include <hive/encoder.hpp>
#include <hive/protocol/messages.hpp>

#include <string>

namespace hive::event {

/// Decided when the receiver registers, and refined by each event. Pure logic, for one thread.
class EncodingChoice {
public:
    enum class Way { one_machine, network };

    /// Throws Errc::invalid_argument when the encoder does not know what was asked for, and Errc::type_mismatch when
    /// the receiver does not take it.
    /// @param encoder  of the output; kept by reference
    EncodingChoice(const Encoder& encoder, const protocol::Registration& registration, Way way);

    /// The encoding for this event; empty: as it is.
    std::string of(const Event& event);
    static constexpr const char* as_it_is = "as it is";
    /// For people: "jpeg:80", or the above.
    [[nodiscard]] std::string word() const;

private:
    void require_known(const protocol::Registration& registration) const;
    /// The preferred encoding that the receiver takes, or empty.
    [[nodiscard]] std::string preferred() const;
    [[nodiscard]] bool met_by(const Event& event, const std::string& encoding) const;

    const Encoder& encoder_;
    std::string accepts_;
    std::string always_;      ///< whatever the event is
    bool fell_back_ = false;  ///< the last event had to be encoded because the receiver does not take it as it is
};

}  // namespace hive::event
