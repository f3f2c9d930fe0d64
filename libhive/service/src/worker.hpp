// The user thread of a drone: the loop, the callbacks, main, and the handling of exceptions.
#pragma once

#include "emitter.hpp"
#include "failure_keeper.hpp"
#include "reporter.hpp"
#include "status_board.hpp"

#include <hive/event/answer_filter.hpp>

#include <map>

namespace hive::service {

/// Everything except halt() runs on the user thread. The network side reaches it only by commands in the mailbox.
class Worker {
public:
    /// The parts that it uses, which outlive it.
    struct Parts {
        Declaration& declaration;
        StatusBoard& board;
        Reporter& reporter;
        Emitter& emitter;
        event::Mailbox& mailbox;
        event::Module& module;
        FailureKeeper& failures;
    };
    explicit Worker(const Parts& parts) : parts_(parts) {}

    /// Works until the drone is told to stop.
    void run();
    /// Works until the drone is told to stop, or until this time.
    void run(event::Clock::time_point until);
    /// Assigns checked values and calls on_change. If that throws, the values are reverted and the error is returned.
    [[nodiscard]] std::optional<Error> try_out(const Json& values);
    /// The tried values of the parameters in `wanted`.
    [[nodiscard]] Json tried(const Json& wanted) const { return parts_.declaration.parameters.assigned(wanted); }
    /// Keeps the tried values and reports them from now on.
    void keep(const Json& values) { parts_.declaration.parameters.read_back(values); }
    /// Reverts the values, and calls on_change again.
    void put_back();
    /// Any thread. The running callback finishes; nothing more is started or requested, and shared work is returned to
    /// its group.
    /// @param by  the peer that asked for it; empty: the drone itself
    void halt(const std::string& by = {});
    /// Discards waiting live events, so that the drone continues with the newest.
    void resume();
    /// The inputs have ended: calls on_end, then ends the outputs.
    /// @param still  network side: does that still hold when the outputs are about to end?
    void inputs_ended(const std::string& text, const std::function<bool()>& still);

private:
    void work_once();
    void step();
    void deliver(Event&& event);
    void to_partners(Event event, MatchedInputs& matching, const MatchedInput& input);
    void work_on_sets();
    bool work(const Set& set, const std::function<void()>& callback);
    void failed(const Set& set, const Error& error, const Event* lost = nullptr);
    void require_type(const Event& event) const;
    [[nodiscard]] bool steps() const;
    [[nodiscard]] event::Clock::time_point next_deadline() const;

    Parts parts_;
    event::Clock::time_point next_step_ = event::Clock::now();  ///< of main
    std::map<std::string, event::AnswerFilter> filters_;        ///< by input
};

}  // namespace hive::service
