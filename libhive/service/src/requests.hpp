// The network side of a drone: answers applications while user code is busy.
#pragma once

#include "parameter_requests.hpp"
#include "status_report.hpp"
#include "wiring.hpp"

#include <hive/protocol/connect_text.hpp>

namespace hive::service {

/// The network side, except the constructor, which runs before the module starts.
class Requests {
public:
    /// The parts that it uses, which outlive it.
    struct Parts {
        const Declaration& declaration;
        StatusBoard& board;
        Reporter& reporter;
        const event::Home& home;
        const Listening& listening;
        event::Mailbox& mailbox;
        event::Module& module;
        Worker& worker;                                       ///< for commands, and to halt it
        std::function<void()> end;                            ///< stops the drone
        std::function<bool(std::chrono::seconds)> hand_over;  ///< stops it within this time; another process continues
        const DroneOrder& order;                              ///< the drone's start configuration
    };
    explicit Requests(Parts parts);

    /// Waits for the receivers of before a crash, makes the command line's connections, and restores the saved ones.
    void restore(const Json& state, const std::vector<protocol::Connect>& wished,
                 const std::vector<protocol::Expect>& expected);
    /// Answers pending requests, because the drone ends.
    void end() { parameters_.end(); }
    [[nodiscard]] Status status() const { return status_.now(); }

private:
    void add_handlers();
    void expect(const Json& state, const std::vector<protocol::Expect>& expected);
    void on_put(const event::Incoming& incoming);
    bool set_policy(const event::Incoming& incoming);
    void on_forget(const event::Incoming& incoming);
    void on_halt(const event::Incoming& incoming);
    void on_resume(const event::Incoming& incoming);
    void on_stop(const event::Incoming& incoming);

    Parts parts_;
    StateFile state_file_;
    Wiring wiring_;
    ParameterRequests parameters_;
    StatusReport status_;
};

}  // namespace hive::service
