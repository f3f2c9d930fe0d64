// Answers get and set: the drone's code tries each set, which is then kept or reverted.
#pragma once

#include "proposal.hpp"
#include "set_turns.hpp"
#include "state_file.hpp"
#include "worker.hpp"

#include <map>

namespace hive::service {

/// The network side, except the execution of a set on the user thread.
class ParameterRequests {
public:
    /// The parts that it uses, which outlive it.
    struct Parts {
        const ParameterSet& parameters;
        StatusBoard& board;
        event::Module& module;
        event::Mailbox& mailbox;
        Worker& worker;  ///< for commands alone
        StateFile& state_file;
        bool remote_operator;  ///< members may set the operator's parameters
    };
    explicit ParameterRequests(const Parts& parts) : parts_(parts) {}

    void on_get(const event::Incoming& incoming) const;
    void on_set(const event::Incoming& incoming);
    /// Answers the waiting sets, because the drone ends.
    void end();

private:
    void require_allowed(const event::Incoming& incoming, const Json& wanted) const;
    void on_commit(const event::Incoming& incoming, std::int64_t token);
    void on_abort(const event::Incoming& incoming, std::int64_t token);
    void propose(Proposal::Terms terms);
    void require_free(const std::string& asker);
    [[nodiscard]] ProposalPtr held(const event::Incoming& incoming, std::int64_t token) const;
    void give_up(const ProposalPtr& proposal, const Error& reason);
    void on_deadline(const ProposalPtr& proposal);
    void forget(const ProposalPtr& proposal);
    [[nodiscard]] Error too_late() const;

    // --- the user thread ---
    void carry_out(Worker& worker, const ProposalPtr& proposal);
    void hold(const Worker& worker, Proposal& proposal);
    /// With the turn.
    [[nodiscard]] bool begin(const ProposalPtr& proposal);
    [[nodiscard]] bool settle(Worker& worker, const ProposalPtr& proposal);

    /// Any thread. Of the parameters that `wanted` names.
    [[nodiscard]] Json present_values(const Json& wanted) const;

    Parts parts_;
    std::map<ProposalPtr, platform::Timer> under_way_;  ///< each with its deadline
    ProposalPtr held_;                                  ///< the prepare that blocks the others
    SetTurns turns_;
};

}  // namespace hive::service
