// What a drone is written against: parameters, outputs, callbacks, main, exceptions.
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

class DroneCore;  // the machinery behind the handles below

/// What a parameter may be, apart from its type: `between(1.01, 2.0)`, `one_of({"jpeg", "png"})`, `between(1,
/// 100).in("%")`.
struct Constraint {
    std::optional<double> least, most;
    std::vector<std::string> choices;
    std::string unit;
    bool for_operator = false;

    /// The unit, shown beside the value: "px", "fps", "%".
    [[nodiscard]] Constraint in(std::string unit_name) const
    {
        Constraint copy = *this;
        copy.unit = std::move(unit_name);
        return copy;
    }
    /// For what concerns the drone's machine and not its pictures, as a path or a login: it can be set at the start and
    /// on the machine itself, and over the network only if the drone was started with --remote-operator.
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
    /// Does anybody receive the bodies of this output? If not, there is no need to make one.
    [[nodiscard]] bool wanted() const;
    /// Does anybody receive this output, be it headers alone?
    [[nodiscard]] bool received() const;
    /// For sources that produce on demand: has every receiver of bodies asked for another event (and is there one)?
    [[nodiscard]] bool asked() const;
    /// Does an event that must arrive still wait here for its way to a receiver? What is emitted at another output then
    /// overtakes it.
    [[nodiscard]] bool backlogged() const;

    /// A buffer of so many bytes to fill in place and emit: no copy is made on the way to receivers on this machine,
    /// and there is one picture in memory for any number of them. Never waits; when the shared memory is used up it is
    /// ordinary memory, and the body goes through the sockets. From any thread, once the drone runs.
    [[nodiscard]] Loan loan(std::size_t bytes) const;

    /// Sends an event to whoever wants it. Never waits for a receiver. Inside a callback the event inherits the
    /// identity and time of the input; elsewhere it begins a new one, captured now.
    /// @param header  a JSON object, at most about 60 KiB as text, 15 levels, 256 keys in one object and 16 KiB in one
    /// string: beyond it Errc::too_large is thrown
    /// @param type    the media type of the body; empty: the first one that the output was declared with
    void emit(Json header = Json::object(), Body body = {}, std::string type = {}) const;
    /// As above, with a body that is made only if it is wanted(), or if it has to wait for the first receiver.
    void emit(Json header, const std::function<Body()>& body, std::string type = {}) const;
    /// Begins a new identity with a capture time of its own (and, for a source on demand, lossless). The body is made
    /// only if it is wanted(). A time before 1970 is unknown to receivers; on the steady clock, so is one before the
    /// machine's start.
    void emit_captured(std::chrono::system_clock::time_point captured, bool lossless, Json header,
                       const std::function<Body()>& body, std::string type = {}) const;
    /// For a source that took something which cannot be given, as a damaged file: it has its number in the sequence all
    /// the same, so that whoever counts does not wait for it. Throws; main lets it pass, and the exception that
    /// applications see has the identity that the event would have had.
    [[noreturn]] void fail(std::chrono::system_clock::time_point captured, bool lossless, Errc code,
                           const std::string& text) const;
    /// Sends an event again, as it once was: identity, capture time, hops, header, type and body are those of `event`;
    /// only who sends it is new. Without its body (`size` says that there was one) it goes to those who receive headers
    /// alone.
    void repeat(Event event) const;
    /// The source has come to its end: nothing more will come, unless something is emitted all the same. Receivers are
    /// told behind everything that was emitted before, and drones pass it on, so that whoever collects at the other end
    /// knows that it has everything.
    /// @param text  what is lacking, at most about 1000 bytes: "87 of 196 frames: the file is damaged"; empty: nothing
    void end(const std::string& text = "") const;
    /// What is captured from now on is of another source: a new epoch, numbered from 1, so that drones that keep state
    /// begin anew. After end() that is so by itself; who calls it all the same, once there is something to do again,
    /// has receivers told at once that the end no longer holds, and not only by the first event.
    void begin_source() const;

private:
    friend class Drone;
    Output(DroneCore& core, std::size_t index) : core_(&core), index_(index) {}
    DroneCore* core_;
    std::size_t index_;
};

/// One of several inputs whose events are brought together.
struct MatchedInput {
    std::string name, type, help;
    /// Looks at an event when it arrives, for what can be known without its partners: what it throws abandons that
    /// event.
    std::function<void(const Event&)> check = {};
};

/// A handle on the matching of some inputs; cheap to copy. For the user thread.
class Matching {
public:
    /// Changes the rule, also for the events that wait.
    void rule(Match match) const;

private:
    friend class Drone;
    Matching(DroneCore& core, std::size_t index) : core_(&core), index_(index) {}
    DroneCore* core_;
    std::size_t index_;
};

/// A process with a clear interface. Declarations come first, then run(). All functions are for the thread that calls
/// run() (the user thread) unless they say otherwise; callbacks, parameter changes and main run there, one at a time.
class Drone {
public:
    explicit Drone(DroneCore& core) : core_(core) {}
    Drone(const Drone&) = delete;
    Drone& operator=(const Drone&) = delete;

    // --- declarations ---

    /// The value that a parameter was given and will begin with: by --set, or by what the drone was told before a
    /// crash. Before run(); for drones whose ports depend on it. Nothing: its default. It is checked when the drone
    /// runs.
    [[nodiscard]] std::optional<Json> given(const std::string& parameter) const;
    /// Is that what the drone was told before a crash? Also when it is given the same value now, as by an engine that
    /// starts it again.
    [[nodiscard]] bool remembered(const std::string& parameter) const;
    /// Declares a parameter bound to `variable`, whose present value is the default. `set` assigns it between
    /// callbacks.
    void parameter(const std::string& name, int& variable, const Constraint& constraint, const std::string& help);
    void parameter(const std::string& name, double& variable, const Constraint& constraint, const std::string& help);
    void parameter(const std::string& name, bool& variable, const Constraint& constraint, const std::string& help);
    void parameter(const std::string& name, std::string& variable, const Constraint& constraint,
                   const std::string& help);
    /// Declares an output.
    /// @param type     one media type or several, emitted or encoded to: "application/json", "image/jpeg,image/png"
    /// @param encoder  what connections may have the events encoded by; emit the event as it is at hand
    Output output(const std::string& name, const std::string& type, const std::string& help = "", Encoder encoder = {});
    /// Declares an input and what to do with its events. If `callback` throws, the exception policy decides.
    void on_event(const std::string& input, const std::string& type, std::function<void(const Event&)> callback,
                  const std::string& help = "");
    /// Declares two or more inputs whose events belong together, and what to do with a set of one event of each, in the
    /// order of the inputs. What is emitted for a set has the identity of its first event. If `callback` throws, the
    /// set is abandoned. What finds no partner is counted with the name of the input where it was missing (`ps`,
    /// `status`). Such a drone keeps events, so it is stateful: it cannot share its work.
    Matching on_matched(const std::vector<MatchedInput>& inputs, Match match,
                        std::function<void(const std::vector<Event>&)> callback);
    /// Called after the parameters of one `set` have been assigned, all together. It may change the variables: what
    /// they hold when it returns is what was applied, and the answer to the `set`. If it throws, all are put back, it
    /// is called again, and the `set` is refused with its text. Also called once before the first event, after
    /// on_start.
    void on_change(std::function<void()> callback);
    /// Called once when the drone runs for real (not for --describe): the place to open devices and load models. If it
    /// throws, the drone ends and says why.
    void on_start(std::function<void()> callback);
    /// Called when everything that the inputs receive has come to its end and has been worked on, before the outputs
    /// end too. `text` says what is lacking, empty: nothing. Called again when something came after all.
    void on_end(std::function<void(const std::string& text)> callback);
    /// What a source does: called again and again between callbacks. Returns how long to wait before the next call; it
    /// is called earlier when the demand for an output changes, a parameter was set, or wake() was called. Not called
    /// while halted.
    void main(std::function<std::chrono::microseconds()> step);

    /// Runs until the drone is told to stop. For --describe: prints the interface and returns.
    void run();

    // --- while running ---

    /// Calls main as soon as possible. From any thread.
    void wake();
    /// Ends the drone as the request `stop` would: what is being worked on comes to its end, run() returns, and what
    /// the drone was told is forgotten. For a drone whose world has ended. From any thread, from on_start on; before it
    /// Errc::invalid_argument is thrown.
    void stop();
    /// Sets the state of the drone's world, shown by `ps` and logged: "stalled", "end of source"; empty: all is well.
    /// From any thread.
    void condition(const std::string& text, Reason why = Reason::none, LogLevel level = LogLevel::info);
    /// Says how many events the present source has in all, from its first to its end, so that others can tell how far
    /// it is; 0: unknown, or without end. From any thread.
    void source_events(std::int64_t events);
    /// Reports an exception without throwing: it reaches subscribed applications and stays in the status. From any
    /// thread.
    void report(Errc code, const std::string& text);
    /// Writes a line to the drone's log, unless its --log-level is above `level`. From any thread.
    void log(const std::string& text, LogLevel level = LogLevel::info);
    /// What an application would be told now (SPEC.md, section 6.4); after run(), how it was at the end.
    [[nodiscard]] Status status() const;
    /// True when the drone should end; for loops in threads of the author's own. From any thread.
    [[nodiscard]] bool stopping() const;

private:
    DroneCore& core_;
};

/// What a drone program is.
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
