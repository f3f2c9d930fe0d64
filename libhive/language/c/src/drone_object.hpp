// A drone behind a handle: its callbacks, its parameters, and the rules for threads and times of calls.
#pragma once

#include "event.hpp"
#include "library_thread.hpp"

#include <hive/embedded_drone.hpp>

#include <atomic>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace hive::c {

/// Receives log lines. Outlives the drone, whose network side may still write.
class LogSink {
public:
    using Write = std::function<void(LogLevel, const char* line)>;
    void set(Write write);
    void write(LogLevel level, const std::string& line);

private:
    std::recursive_mutex mutex_;  ///< a callback may release the drone
    std::shared_ptr<const Write> write_ = std::make_shared<Write>();
};

/// The variable of one parameter: the caller's or our own.
struct Variable {
    std::string name{};
    int* integer = nullptr;
    double* number = nullptr;
    bool* flag = nullptr;
    std::string* text = nullptr;
    const char** shown = nullptr;  ///< the caller's, points to the text

    [[nodiscard]] Json value() const;
    void assign(const Json& value) const;
    /// Publishes the text to the caller, or accepts the text that the caller put there.
    void show() const;
    void take() const;
};

class DroneObject final : public Object {
public:
    using Handle = hive_drone;
    static constexpr const char* name = "hive_drone";

    DroneObject(DroneProgram program, EmbeddedOptions options);
    explicit DroneObject(std::unique_ptr<EmbeddedDrone> drone);
    void released() override;

    /// Throw Errc::stopped if all handles of the drone were released.
    std::shared_ptr<EmbeddedDrone> open() const;
    /// For calls before the drone runs. Throws Errc::invalid_argument afterwards.
    std::shared_ptr<EmbeddedDrone> declaring() const;
    /// For the user thread: the last one that ran the drone. Throws Errc::invalid_argument on any other.
    std::shared_ptr<EmbeddedDrone> on_user_thread() const;
    /// Runs with this thread as the user thread. Throws Errc::invalid_argument if called from within.
    void as_user_thread(const std::function<void(EmbeddedDrone&)>& work);

    void begin() { began_ = true; }
    void add(Variable variable) { variables_.push_back(std::move(variable)); }
    [[nodiscard]] Json values() const;
    void assign(const Json& values);
    void on_change(hive_callback callback, void* user) { on_change_ = {callback, user}; }
    /// Calls back, and throws the error for the returned code.
    void call(const std::function<hive_code()>& callback);
    /// The error of the current callback, if it left more than a code.
    void keep_failure(std::exception_ptr failure) { failure_ = std::move(failure); }
    [[nodiscard]] LogSink& log() noexcept { return *log_; }

    /// Variables of parameters that the caller has not bound; their addresses are stable.
    std::deque<int> integers;
    std::deque<double> numbers;
    std::deque<bool> flags;
    std::deque<std::string> texts;

private:
    struct Change {
        hive_callback callback = nullptr;
        void* user = nullptr;
    };
    void watch_changes();

    std::shared_ptr<LogSink> log_ = std::make_shared<LogSink>();
    mutable std::mutex mutex_;
    std::shared_ptr<EmbeddedDrone> drone_;  ///< null: released
    std::atomic<bool> began_ = false;
    std::atomic<bool> inside_ = false;  ///< a thread runs it
    std::atomic<std::thread::id> user_thread_{};
    std::deque<Variable> variables_;
    Change on_change_;
    std::exception_ptr failure_;
};

class OutputObject final : public Object {
public:
    using Handle = hive_output;
    static constexpr const char* name = "hive_output";

    OutputObject(std::shared_ptr<DroneObject> of, Output made) : drone(std::move(of)), output(made) {}
    const std::shared_ptr<DroneObject> drone;
    const Output output;
};

class MatchingObject final : public Object {
public:
    using Handle = hive_matching;
    static constexpr const char* name = "hive_matching";

    MatchingObject(std::shared_ptr<DroneObject> of, Matching made) : drone(std::move(of)), matching(made) {}
    const std::shared_ptr<DroneObject> drone;
    const Matching matching;
};

/// Parses the rule {} or {"tolerance_us": N}.
Match match_of(const char* text);

}  // namespace hive::c
