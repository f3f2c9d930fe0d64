// What a drone was told: kept beside its socket, and taken again after a crash.
#pragma once

#include "listening.hpp"

namespace hive::service {

/// What holds for a drone of this name and another kind.
enum class OtherKind { leave_out, take };

/// What a drone of this name was told that crashed, or that is to be replaced; an empty object when there is nothing of
/// use. Any thread.
[[nodiscard]] Json left_state(const event::Home& home, const protocol::Hello& self, OtherKind other,
                              const Reporter& reporter);
/// The saved values that the drone still takes. The user thread, before the start.
[[nodiscard]] Json still_taken(const Json& saved, const ParameterSet& parameters, const Reporter& reporter);

/// The epoch of the last run, 0 when it is not known or larger than a clock could have made it.
[[nodiscard]] std::int64_t left_epoch(const Json& state, const Reporter& reporter);
/// Whom a drone of this name worked for; those that cannot be read are left out.
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

    /// Writes what the drone is told now. One that cannot write goes on without, and says so once.
    void remember();
    /// The same, if others are waited for than it says.
    void subscribers_changed();

private:
    [[nodiscard]] Json state() const;

    const event::Home& home_;
    const event::Module& module_;
    const Declaration& declaration_;
    const StatusBoard& board_;
    const Listening& listening_;
    Reporter& reporter_;
    std::vector<event::Subscriber> subscribers_;  ///< as written
    bool forgetful_ = false;                      ///< the state cannot be written, which was reported
};

}  // namespace hive::service
