// The machinery of a running drone: the user thread's loop, its callbacks, and what the network side may see of it.
#pragma once

#include "parameter_set.hpp"

#include <hive/drone.hpp>
#include <hive/event/mailbox.hpp>
#include <hive/event/matcher.hpp>
#include <hive/event/module.hpp>
#include <hive/event/sequence_filter.hpp>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace hive {

/// What the command line of a drone says.
struct DroneSettings {
    std::string name;
    std::vector<std::string> listen;        ///< further addresses beside the local socket
    Json parameters = Json::object();       ///< --set
    std::optional<ExceptionPolicy> policy;  ///< empty: as before the crash, or skip
    bool describe = false;
};

/// What a source could not give, which has a number all the same.
class CaptureFailed : public Error {
public:
    CaptureFailed(const Error& error, Identity identity) : Error(error) { lost_.identity = std::move(identity); }
    [[nodiscard]] const Event& lost() const noexcept { return lost_; }

private:
    Event lost_;
};

/// Declarations and the loop belong to the user thread; handlers of requests (drone_requests.cpp) and what outlives a
/// crash (drone_state.cpp) to the network side; what both need is in `board_` under its mutex.
class DroneCore {
public:
    DroneCore(DroneProgram program, DroneSettings settings);
    ~DroneCore();

    // declarations
    ParameterSet parameters;
    Interface interface;
    std::map<std::string, std::function<void(const Event&)>> callbacks;
    std::function<void()> on_change = [] {}, on_start = [] {};
    std::function<std::chrono::microseconds()> main;
    std::size_t add_output(Port port, Encoder encoder);
    struct MatchedInputs {
        std::vector<MatchedInput> inputs;
        event::Matcher matcher;
        std::function<void(const std::vector<Event>&)> callback;

        [[nodiscard]] const MatchedInput* input(const std::string& name) const;
    };
    std::deque<MatchedInputs> matchings;
    std::size_t add_matching(const std::vector<MatchedInput>& inputs, Match match,
                             std::function<void(const std::vector<Event>&)> callback);

    void run();

    // for Output and Drone
    /// Any thread.
    [[nodiscard]] Loan loan(std::size_t bytes);
    [[nodiscard]] bool wanted(std::size_t output) const;
    [[nodiscard]] bool received(std::size_t output) const;
    [[nodiscard]] bool asked(std::size_t output) const;
    /// @param body  gives nothing when nobody wants it
    void emit(std::size_t output, std::optional<Identity> begun, Json header,
              const std::function<std::optional<Body>()>& body, std::string type);
    [[noreturn]] void fail(std::size_t output, std::int64_t captured_us, bool lossless, const Error& error);
    void repeat(std::size_t output, Event event);
    [[nodiscard]] std::optional<Json> given(const std::string& parameter) const;
    [[nodiscard]] bool remembered(const std::string& parameter) const
    {
        return !settings_.parameters.contains(parameter) && given(parameter);
    }
    [[nodiscard]] Json status();
    void wake();
    void condition(const std::string& text);
    void report(Errc code, const std::string& text, const Event* cause);
    void log(const std::string& text) const;
    [[nodiscard]] bool stopping() const noexcept { return stopping_; }
    /// Its number is taken when the event is sent.
    [[nodiscard]] Identity fresh_identity(std::size_t output, std::int64_t captured_us, bool lossless) const;

private:
    using Clock = std::chrono::steady_clock;
    struct Slot {         ///< one output
        Encoder encoder;  ///< until the outlet has it
        event::Outlet* outlet = nullptr;
        std::int64_t sequence = 0;     ///< user thread
        int part = 0;                  ///< events emitted for the present input
        std::atomic<int> handover{0};  ///< emitted, not yet with the network side
    };
    struct Board {  ///< what status tells of the user thread
        State state = State::starting;
        std::string condition, callback;
        ExceptionPolicy policy{};
        std::int64_t busy_us = 0;
        Clock::time_point busy_since{};
        std::int64_t received = 0, processed = 0, abandoned = 0, duplicates = 0, discarded = 0, dropped = 0;
        std::map<std::string, std::int64_t> abandoned_at;  ///< by input
        Json last_exception;
        std::vector<MatchCounts> matched;  ///< one for each of `matchings`
    };
    using Set = std::vector<Event>;  ///< what is worked on: events that were brought together, mostly a single one

    // user thread
    void prepare();
    void loop();
    void step();
    void deliver(Event&& event);
    bool work(const Set& set, const std::function<void()>& callback);
    void require_type(const Event& event) const;
    void processed(const Set& set);
    void failed(const Set& set, Errc code, const std::string& text, const Event* lost = nullptr);
    void to_partners(Event event, MatchedInputs& matching, const MatchedInput& input);
    void work_on_sets();
    [[nodiscard]] Clock::time_point next_deadline() const;
    Identity inherited(Slot& slot) const;
    [[nodiscard]] const Port& port_to_emit(std::size_t output, const Json& header) const;
    void send(std::size_t output, Event event, bool complete);
    void set_state(State state);
    void begin_work(const std::string& what);
    void end_work();
    void apply(const Json& values);

    // network side: drone_requests.cpp
    void add_handlers();
    void on_connect(event::Incoming incoming);
    std::shared_ptr<event::Intake> add_intake(event::IntakeSpec spec);
    void connect(event::IntakeSpec spec, event::OnOutcome on_outcome);
    void on_disconnect(const event::Incoming& incoming);
    [[nodiscard]] Json present_values(const Json& wanted) const;
    void on_set(const event::Incoming& incoming);
    void on_get(const event::Incoming& incoming);
    void on_put(const event::Incoming& incoming);
    bool set_policy(const event::Incoming& incoming);
    void on_halt(const event::Incoming& incoming);
    void on_resume(const event::Incoming& incoming);
    void end(bool forget);
    void arrived(Event&& event, const std::weak_ptr<event::Intake>& intake);
    event::IntakeSpec intake_spec(const Json& from, const std::string& input, const ConnectionOptions& options) const;
    [[nodiscard]] Json status_now();
    [[nodiscard]] Json matching_status(const Board& board) const;

    // drone_state.cpp: before the start
    [[nodiscard]] Json left_state(const event::Home& home) const;
    [[nodiscard]] Json still_taken(const Json& saved) const;
    // drone_state.cpp: network side
    void restore(const Json& state);
    [[nodiscard]] Json state() const;
    void remember();

    DroneProgram program_;
    DroneSettings settings_;
    std::optional<event::Home> home_;
    std::optional<event::NameClaim> claim_;
    std::list<Slot> slots_;
    std::vector<Slot*> outputs_;
    event::Outlet* exceptions_ = nullptr;
    event::Mailbox mailbox_;
    event::SequenceFilter filter_;  ///< network side
    bool forgetful_ = false;        ///< network side: the state cannot be written, which was reported
    std::unique_ptr<event::Module> module_;
    std::atomic<bool> stopping_ = false, halted_ = false;
    std::int64_t epoch_ = 0;
    Clock::time_point started_{}, next_step_{};
    const Set* current_ = nullptr;  ///< what is being worked on
    Clock::time_point current_since_{};
    std::mutex handover_mutex_;
    std::condition_variable handover_less_;
    mutable std::mutex board_mutex_;
    Board board_;
    Json last_status_;  ///< user thread, after the loop
};

}  // namespace hive
