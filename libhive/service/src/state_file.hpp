// The state of a drone: saved next to its socket, and restored after a crash.
#pragma once

#include "listening.hpp"

namespace hive::service {

/// The part of a state that is valid for a drone of this name and another kind.
enum class OtherKind { leave_out, take };

/// The state of a drone of this name that crashed, or that is to be replaced, or what one left that is to return; an
/// empty object if there is none. Any thread.
[[nodiscard]] Json left_state(const event::Home& home, const protocol::Hello& self, OtherKind other,
                              const Reporter& reporter);
/// The saved values that the drone still accepts. The user thread, before the start.
[[nodiscard]] Json still_taken(const Json& saved, const ParameterSet& parameters, const Reporter& reporter);

/// Is it what a drone left that is to return, and not a state?
[[nodiscard]] bool is_to_return(const Json& state);

/// The epoch of the last run; 0 if unknown, or larger than any plausible clock.
[[nodiscard]] std::int64_t left_epoch(const Json& state, const Reporter& reporter);
/// The subscribers of a drone of this name; invalid ones are skipped.
[[nodiscard]] std::vector<event::Subscriber> subscribers_from(const Json& state, const Reporter& reporter);

/// The network side.
class StateFile {
public:
    StateFile(const event::Home& home, const event::Module& module, const Declaration& declaration,
              const StatusBoard& board, const Listening& listening, Reporter& reporter)
        : home_(home),
          module_(module),
          declaration_(declaration),
          board_(board),
          listening_(listening),
          reporter_(reporter)
    {
    }

    /// Saves the current state. If that fails, the drone continues without, and reports it once.
    void remember();
    /// From now on saves only what a process needs that is started at once with all its settings, instead of a state.
    void remember_to_return();
    /// The same as remember(), if the subscribers have changed.
    void subscribers_changed();

private:
    [[nodiscard]] Json wired() const;  ///< the epoch, connections and subscribers
    [[nodiscard]] Json state() const;

    const event::Home& home_;
    const event::Module& module_;
    const Declaration& declaration_;
    const StatusBoard& board_;
    const Listening& listening_;
    Reporter& reporter_;
    std::vector<event::Subscriber> subscribers_;  ///< as written
    bool returns_ = false;
    bool forgetful_ = false;  ///< the state cannot be written, and that was reported
};

}  // namespace hive::service
