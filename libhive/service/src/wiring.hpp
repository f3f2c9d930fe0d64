// The connections of a drone's inputs: makes, replaces, ends, and restores them after a crash.
#pragma once

#include "state_file.hpp"
#include "worker.hpp"

#include <hive/protocol/requests.hpp>

namespace hive::service {

/// The network side.
class Wiring {
public:
    Wiring(const Declaration& declaration, const event::Home& home, event::Module& module, event::Mailbox& mailbox,
           Worker& worker, StateFile& state_file, const Reporter& reporter)
        : declaration_(declaration),
          home_(home),
          module_(module),
          mailbox_(mailbox),
          worker_(worker),
          state_file_(state_file),
          reporter_(reporter)
    {
    }

    void on_connect(const event::Incoming& incoming);
    void on_disconnect(const event::Incoming& incoming);
    /// Makes connections as soon as their senders are up, and after each restart of a sender.
    void begin(const std::vector<protocol::Connect>& connections);
    /// The same for the connections of before a crash, except existing ones.
    /// @param connections  as in the state file
    void restore(const Json& connections);

private:
    [[nodiscard]] event::IntakeSpec intake_spec(const protocol::Connect& connect) const;
    std::shared_ptr<event::Intake> add_intake(event::IntakeSpec spec);
    void connect(event::IntakeSpec spec, event::Clock::time_point until, event::OnOutcome on_outcome);
    void begin(event::IntakeSpec spec);
    struct Said {  ///< last, about an intake
        std::string line;
        bool connected = false;
    };
    void say(const event::Intake& intake, Said& said) const;
    [[nodiscard]] std::vector<std::shared_ptr<event::Intake>> earlier_ones(const event::IntakeSpec& spec) const;
    void replace_earlier(const std::shared_ptr<event::Intake>& intake, const event::Outcome& outcome);
    void pass_end_on();

    const Declaration& declaration_;
    const event::Home& home_;
    event::Module& module_;
    event::Mailbox& mailbox_;
    Worker& worker_;  ///< for commands alone
    event::EndOfInputs end_{event::EndOfInputs::Of::drone};
    StateFile& state_file_;
    const Reporter& reporter_;
};

}  // namespace hive::service
