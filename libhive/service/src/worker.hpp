// The user thread of a drone at work: the loop, the callbacks, main, and what comes of exceptions.
#pragma once

#include "emitter.hpp"
#include "failure_keeper.hpp"
#include "reporter.hpp"
#include "status_board.hpp"

#include <hive/event/answer_filter.hpp>

#include <map>

namespace hive::service {

/// Everything here but halt() runs on the user thread. The network side reaches it only by commands of the mailbox.
class Worker {
public:
    /// What it uses, which outlives it.
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
    /// Works until the drone is told to stop, or until that time.
    void run(event::Clock::time_point until);
    /// Assigns checked values and calls on_change. What that throws is returned, and the old values are back.
    [[nodiscard]] std::optional<Error> try_out(const Json& values);
    /// What the parameters that `wanted` names are while they are tried out.
    [[nodiscard]] Json tried(const Json& wanted) const { return parts_.declaration.parameters.assigned(wanted); }
    /// What was tried out is told from now on.
    void keep(const Json& values) { parts_.declaration.parameters.read_back(values); }
    /// The values from before are back, and on_change is called again.
    void put_back();
    /// Any thread. What is being worked on comes to its end; nothing more is begun or asked for, and shared work goes
    /// back to its group.
    void halt();
    /// Live events that waited are discarded, so that the drone continues with the newest.
    void resume();
    /// Nothing more comes to the inputs: the author's code is told, then the outputs end.
    /// @param still  network side: is it so when the outputs are to end?
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
