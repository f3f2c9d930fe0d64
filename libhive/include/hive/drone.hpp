// The interface for drones: parameters, outputs, callbacks, main, exceptions.
#pragma once

#include <hive/encoder.hpp>
#include <hive/error.hpp>
#include <hive/event.hpp>
#include <hive/interface.hpp>
#include <hive/log_level.hpp>
#include <hive/match.hpp>
#include <hive/status.hpp>
#include <hive/transfer.hpp>

#include <chrono>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

namespace hive {

class DroneCore;  // the implementation behind the handles below

/// The constraint of a parameter besides its type: `between(1.01, 2.0)`, `one_of({"jpeg", "png"})`, `between(1,
/// 100).in("%")`.
struct Constraint {
    std::optional<double> least, most;
    std::vector<std::string> choices;
    std::string unit;
    bool for_operator = false;

    /// The unit, shown next to the value: "px", "fps", "%".
    [[nodiscard]] Constraint in(std::string unit_name) const
    {
        Constraint copy = *this;
        copy.unit = std::move(unit_name);
        return copy;
    }
    /// For a parameter that affects the drone's machine rather than its images, such as a path or a login: it can be
    /// set at the start and on the machine itself, and over the network only if the drone was started with
    /// --remote-operator.
    [[nodiscard]] Constraint by_operator() const
    {
        Constraint copy = *this;
        copy.for_operator = true;
        return copy;
    }
};
inline Constraint anything() { return {}; }
inline Constraint between(double least, double most) { return {least, most, {}, {}, false}; }
inline Constraint at_least(double least) { return {least, std::nullopt, {}, {}, false}; }
inline Constraint one_of(std::initializer_list<const char*> choices)
{
    return {std::nullopt, std::nullopt, {choices.begin(), choices.end()}, {}, false};
}

/// A handle on one of the drone's outputs; cheap to copy. For the user thread.
class Output {
public:
    /// True if any receiver takes bodies of this output. If not, you need not make one.
    [[nodiscard]] bool wanted() const;
    /// True if it has receivers, even of headers only.
    [[nodiscard]] bool received() const;
    /// For sources on demand: true if the output has receivers of bodies and each of them has requested another event.
    [[nodiscard]] bool asked() const;
    /// True if a lossless event still waits here to be sent. Events emitted at another output then overtake it.
    [[nodiscard]] bool backlogged() const;

    /// A buffer of this size to fill in place and emit: receivers on this machine map it without a copy, however many
    /// there are. Never blocks; when the shared memory is used up, the buffer is ordinary memory and the body goes
    /// through the sockets. From any thread, once the drone runs.
    [[nodiscard]] Loan loan(std::size_t bytes) const;

    /// Sends an event to its receivers. Never blocks on one. Inside a callback the event inherits the identity and time
    /// of the input; elsewhere it gets a new identity, captured now.
    /// @param header  a JSON object, at most about 60 KiB as text, 15 levels, 256 keys in one object and 16 KiB in one
    /// string: a larger one throws Errc::too_large
    /// @param type    the media type of the body; empty: the first one that the output was declared with
    void emit(Json header = Json::object(), Body body = {}, std::string type = {}) const;
    /// As above; `body` is called only if the output is wanted(), or if the event has to wait for the first receiver.
    void emit(Json header, const std::function<Body()>& body, std::string type = {}) const;
    /// Emits with a new identity and this capture time (and, for a source on demand, lossless). `body` is called only
    /// if the output is wanted(). Receivers treat a time before 1970 as unknown, and on the steady clock also a time
    /// before the machine's start.
    void emit_captured(std::chrono::system_clock::time_point captured, bool lossless, Json header,
                       const std::function<Body()>& body, std::string type = {}) const;
    /// For a source item that cannot be sent, such as a damaged file: it still takes a sequence number, so that ordered
    /// collectors do not wait for it. Throws an exception that main must not catch; applications see it with the
    /// identity that the event would have had.
    [[noreturn]] void fail(std::chrono::system_clock::time_point captured, bool lossless, Errc code,
                           const std::string& text) const;
    /// Sends an event again unchanged: identity, capture time, hops, header, type and body are those of `event`; only
    /// the sender is new. An event without its body (`size` says that there was one) goes only to receivers of headers.
    void repeat(Event event) const;
    /// Ends the source: nothing more will come, unless something is emitted after all. Receivers get the end after
    /// everything that was emitted before, and drones pass it on, so that collectors know that they have everything.
    /// @param text  what is missing, at most about 1000 bytes: "87 of 196 frames: the file is damaged"; empty: nothing
    void end(const std::string& text = "") const;
    /// Starts another source: a new epoch, numbered from 1, so that stateful drones reset. The first event after end()
    /// starts one by itself; calling this earlier revokes the end at the receivers at once.
    void begin_source() const;

private:
    friend class Drone;
    Output(DroneCore& core, std::size_t index) : core_(&core), index_(index) {}
    DroneCore* core_;
    std::size_t index_;
};

/// One of several inputs whose events are matched.
struct MatchedInput {
    std::string name, type, help;
    /// Validates an event on arrival, before it is matched; if it throws, the event is abandoned.
    std::function<void(const Event&)> check = {};
};

/// A handle on the matching of some inputs; cheap to copy. For the user thread.
class Matching {
public:
    /// Changes the rule, even for waiting events.
    void rule(Match match) const;

private:
    friend class Drone;
    Matching(DroneCore& core, std::size_t index) : core_(&core), index_(index) {}
    DroneCore* core_;
    std::size_t index_;
};

/// Declarations come first, then run(). All functions are for the thread that calls run() (the user thread) unless they
/// say otherwise; callbacks, parameter changes and main run there, one at a time.
class Drone {
public:
    explicit Drone(DroneCore& core) : core_(core) {}
    Drone(const Drone&) = delete;
    Drone& operator=(const Drone&) = delete;

    // --- declarations ---

    /// The initial value given to a parameter: by --set, or restored after a crash. Before run(); for drones whose
    /// ports depend on it. Nothing: the default holds. run() checks the value.
    [[nodiscard]] std::optional<Json> given(const std::string& parameter) const;
    /// True if that value was restored after a crash, even if --set gives the same value, as when an engine restarts
    /// the drone.
    [[nodiscard]] bool remembered(const std::string& parameter) const;
    /// Declares a parameter bound to `variable`, whose current value is the default. `set` assigns it between
    /// callbacks.
    void parameter(const std::string& name, int& variable, const Constraint& constraint, const std::string& help);
    void parameter(const std::string& name, double& variable, const Constraint& constraint, const std::string& help);
    void parameter(const std::string& name, bool& variable, const Constraint& constraint, const std::string& help);
    void parameter(const std::string& name, std::string& variable, const Constraint& constraint,
                   const std::string& help);
    /// Declares an output.
    /// @param type     one media type or several, emitted or encoded to: "application/json", "image/jpeg,image/png"
    /// @param encoder  the encodings that connections may ask for; emit events unencoded
    Output output(const std::string& name, const std::string& type, const std::string& help = "", Encoder encoder = {});
    /// Declares an input and the callback for its events. If `callback` throws, the exception policy decides.
    void on_event(const std::string& input, const std::string& type, std::function<void(const Event&)> callback,
                  const std::string& help = "");
    /// Declares two or more inputs whose events belong together, and the callback for a set of one event each, in the
    /// order of the inputs. Events emitted for a set have the identity of its first event. If `callback` throws, the
    /// set is abandoned. Unmatched events are counted by the input where the partner was missing (`ps`, `status`). Such
    /// a drone keeps events, so it is stateful: it cannot share its work.
    Matching on_matched(const std::vector<MatchedInput>& inputs, Match match,
                        std::function<void(const std::vector<Event>&)> callback);
    /// Called after the parameters of one `set` have been assigned, all together. It may change the variables: their
    /// values when it returns are applied and answer the `set`. If it throws, all are reverted, it is called again, and
    /// the `set` is refused with its text. Also called once before the first event, after on_start.
    void on_change(std::function<void()> callback);
    /// Called once when the drone runs (not for --describe); open devices and load models here. If it throws, the drone
    /// exits and reports the error.
    void on_start(std::function<void()> callback);
    /// Called when all inputs have ended and every event has been processed, before the outputs end. `text` says what
    /// is missing, empty: nothing. Called again if more events arrive.
    void on_end(std::function<void(const std::string& text)> callback);
    /// A source's step, called repeatedly between callbacks. Returns how long to wait before the next call; the call
    /// comes earlier when the demand for an output changes, a parameter was set, or wake() was called. Not called while
    /// halted.
    void main(std::function<std::chrono::microseconds()> step);

    /// Runs until the drone is told to stop. For --describe: prints the interface and returns.
    void run();

    // --- while running ---

    /// Calls main as soon as possible. From any thread.
    void wake();
    /// Stops the drone as the request `stop` would: the running callback finishes, run() returns, and the saved state
    /// is deleted. For a drone that has nothing left to do. From any thread, from on_start on; earlier it throws
    /// Errc::invalid_argument.
    void stop();
    /// Sets the drone's condition, shown by `ps` and logged: "stalled", "end of source"; empty: all is well. From any
    /// thread.
    void condition(const std::string& text, Reason why = Reason::none, LogLevel level = LogLevel::info);
    /// Sets the total number of events of the current source, so that others can show progress; 0: unknown or
    /// unlimited. From any thread.
    void source_events(std::int64_t events);
    /// Reports an exception without throwing: it reaches subscribed applications and stays in the status. From any
    /// thread.
    void report(Errc code, const std::string& text);
    /// Writes a line to the drone's log, unless its --log-level is above `level`. From any thread.
    void log(const std::string& text, LogLevel level = LogLevel::info);
    /// The status as an application would get it now (SPEC.md, section 6.4); after run(), the last one.
    [[nodiscard]] Status status() const;
    /// True when the drone should stop; for loops in your own threads. From any thread.
    [[nodiscard]] bool stopping() const;

private:
    DroneCore& core_;
};

struct DroneProgram {
    std::string kind;       ///< "face"
    std::string summary;    ///< one sentence for --help and describe
    bool stateful = false;  ///< keeps state between events: its work cannot be shared
};

/// The main function of a drone: reads the command line that all drones share, lets `body` declare and run the drone.
/// Returns the exit code.
///
///     int main(int argc, char** argv) { return hive::run_drone(argc, argv, {"face", "Finds faces."}, face_detector); }
int run_drone(int argc, char** argv, const DroneProgram& program, const std::function<void(Drone&)>& body);

}  // namespace hive
