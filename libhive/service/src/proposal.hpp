// One set in progress: it waits for the user thread, the drone's code tries it there, and it is decided once.
#pragma once

#include <hive/event/clock.hpp>
#include <hive/event/link.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace hive::service {

/// The network side. Each asker is answered exactly once. Knows neither threads nor sockets.
class Proposal {
public:
    using Answer = std::function<void(const event::Outcome&)>;

    /// How long a prepared set is held beyond its deadline: the asker decides by the deadline, and its packet arrives
    /// later.
    static constexpr std::chrono::seconds grace{1};

    struct Terms {
        Json values;  ///< checked
        event::Clock::time_point deadline;
        std::optional<std::int64_t> token;  ///< of a prepare, which its asker decides; a plain set needs no decision
        std::string asker;
        const void* connection;           ///< only this one decides a prepare
        std::function<bool()> connected;  ///< is the asker still there?
        Answer answer;
    };

    explicit Proposal(Terms terms) : terms_(std::move(terms)) {}

    [[nodiscard]] const Json& values() const noexcept { return terms_.values; }
    [[nodiscard]] const std::string& asker() const noexcept { return terms_.asker; }
    [[nodiscard]] event::Clock::time_point deadline() const noexcept { return terms_.deadline; }
    [[nodiscard]] bool by_asker() const noexcept { return terms_.token.has_value(); }
    [[nodiscard]] bool has(std::int64_t token, const void* connection) const noexcept
    {
        return terms_.token == token && terms_.connection == connection;
    }

    /// Not decided yet.
    [[nodiscard]] bool undecided() const noexcept { return state_ == State::waiting || state_ == State::prepared; }
    /// Undecided, and the asker that must decide is still connected.
    [[nodiscard]] bool wanted() const { return undecided() && (!by_asker() || terms_.connected()); }
    [[nodiscard]] bool prepared() const noexcept { return state_ == State::prepared; }
    [[nodiscard]] bool committed() const noexcept { return state_ == State::committed; }

    /// The drone's code has accepted the values of a prepare. Does nothing when it is decided already.
    void prepare(const Json& result);
    /// Decides that the values hold. @param answer  what to confirm(); none: the request of the set
    void commit(std::optional<Answer> answer = {});
    /// The values hold: answers the request that asked for it.
    void confirm(const Json& result);
    /// Decides that the old values hold, unless it is decided already. Pending requests get this answer.
    void give_up(const Error& reason);

private:
    enum class State { waiting, prepared, committed, given_up };
    void answer(const event::Outcome& outcome);

    Terms terms_;
    State state_ = State::waiting;
};

using ProposalPtr = std::shared_ptr<Proposal>;

}  // namespace hive::service
