// Starts the process that takes over, and waits until it answers to the name.
#include "inquiry.hpp"
#include "successor_fit.hpp"

#include <hive/event/home.hpp>
#include <hive/name.hpp>
#include <hive/process.hpp>
#include <hive/program.hpp>
#include <hive/replace.hpp>

#include <sstream>
#include <sys/wait.h>

namespace hive {
namespace {

using namespace std::chrono_literals;
using SteadyClock = std::chrono::steady_clock;

constexpr int most_attempts = 3;             ///< a successor that dies once the old one is asked is started again
constexpr auto patience_to_hand_over = 45s;  ///< the old one may be inside a long callback
constexpr auto a_moment_more = 1s;           ///< who is late ends by itself
constexpr std::size_t most_last_lines = 15;

Predecessor predecessor(Application& application, const event::Home& home, const std::string& drone)
{
    Predecessor before{.interface = application.describe(drone), .status = application.status(drone), .parameters = {}};
    const auto state = home.read_state(drone).value_or(Json::object());
    const Fields fields(state, "the state of " + drone);
    before.parameters = fields.has("parameters") ? fields.object("parameters") : Json::object();
    return before;
}

void require_forgettable(const Predecessor& before, const ReplaceOptions& options)
{
    if (before.interface.stateful && !options.lose_state)
        throw Error(Errc::refused,
                    before.status.name + " remembers earlier events, and the new one would begin with an empty memory",
                    "if that may be: --lose-state");
}

/// The error that has this exit code, as far as a drone that has not begun can have met it.
Errc error_of(int status)
{
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    for (const auto error : {Errc::invalid_argument, Errc::not_found, Errc::unreachable, Errc::refused,
                             Errc::type_mismatch, Errc::timeout})
        if (info(error).exit_code == code)
            return error;
    return Errc::failed;
}

/// One process that is to take over.
class Successor {
public:
    Successor(Application& application, const event::Home& home, const std::string& drone, const std::string& kind,
              const ReplaceOptions& options, std::int64_t predecessor)
        : application_(application),
          home_(home),
          drone_(drone),
          options_(options),
          predecessor_(predecessor),
          inquiry_(application),
          process_(start(home, drone, kind, options))
    {
    }

    /// Returns when it has taken over, even if it has been replaced itself by then.
    /// @return  false: it has died after the old one was asked to hand over
    bool await();
    [[nodiscard]] pid_t pid() const { return process_.pid(); }

private:
    static BackgroundProcess start(const event::Home& home, const std::string& drone, const std::string& kind,
                                   const ReplaceOptions& options);
    [[nodiscard]] bool asked() const { return home_.successor(drone_) == process_.pid(); }
    [[nodiscard]] bool answers();
    [[nodiscard]] bool was_followed(int status) const;
    [[noreturn]] void fail(Errc code, const std::string& what) const;

    Application& application_;
    const event::Home& home_;
    const std::string& drone_;
    const ReplaceOptions& options_;
    std::int64_t predecessor_;
    Inquiry inquiry_;
    BackgroundProcess process_;
};

BackgroundProcess Successor::start(const event::Home& home, const std::string& drone, const std::string& kind,
                                   const ReplaceOptions& options)
{
    const auto command = command_of(kind);
    auto words = command.arguments, environment = command.environment;
    const auto seconds = std::chrono::duration<double>(options.ready_within).count();
    words.insert(words.end(), {"--name", drone, "--take-over", std::to_string(seconds)});
    for (const auto& [name, value] : options.parameters.items())
        words.insert(words.end(), {"--set", assignment(name, value)});
    words.insert(words.end(), options.arguments.begin(), options.arguments.end());
    environment.push_back("HIVE_HOME=" + home.directory().string());
    return {command.program, words, environment, home.path(drone, ".log"), BackgroundProcess::Life::own};
}

/// The lock says whose the name is, so nobody is asked before there is something to hear.
bool Successor::answers()
{
    if (home_.holder(drone_) != process_.pid())
        return false;
    const auto answer = application_.status(std::vector{drone_ + "@" + Place::here}).at(0);
    return !answer.error && answer.status.pid == process_.pid() && answer.status.state != State::starting;
}

/// It took over and was then replaced itself: it ended in order, and the drone goes on, not in the old process.
bool Successor::was_followed(int status) const
{
    return status == 0 && home_.holder(drone_) != predecessor_ && (home_.alive(drone_) || home_.succession(drone_));
}

void Successor::fail(Errc code, const std::string& what) const
{
    std::istringstream lines(process_.last_words(most_last_lines));
    for (std::string line; std::getline(lines, line);)
        options_.last_words(line);
    throw Error(code, "the process that was to take over " + drone_ + " " + what,
                "see more of its log: hivectl logs " + drone_);
}

bool Successor::await()
{
    const auto begun = SteadyClock::now();
    while (!answers()) {
        const auto status = process_.ended();
        if (status && asked())
            return false;
        if (status && was_followed(*status))
            return true;
        if (status)
            fail(error_of(*status), how_its_start_ended(*status));
        const auto waited = SteadyClock::now() - begun;
        if (options_.cancelled && options_.cancelled())
            throw Error(Errc::stopped, "cancelled; the process that takes over from " + drone_ + " goes on by itself");
        if (!asked() && waited > options_.ready_within + a_moment_more) {
            process_.end();
            if (asked())
                return false;  // just then
            fail(Errc::timeout, "was not ready in time, and was ended");
        }
        if (waited > options_.ready_within + patience_to_hand_over)
            fail(Errc::timeout, "still waits for it to end");
        inquiry_.wait(SteadyClock::now() + 3ms, {process_.descriptor()});
    }
    return true;
}

}  // namespace

Replaced replace(Application& application, const std::string& drone, const ReplaceOptions& options)
{
    const event::Home home(options.home.empty() ? default_home() : options.home);
    const auto place = application.place(drone);
    if (place.host != Place::here)
        throw Error(Errc::refused, drone + " runs on " + place.host, "replace it there");
    auto before = predecessor(application, home, place.drone);
    const auto started_as = before.status.order.value_or(DroneOrder{}).kind;
    const auto kind = !options.kind.empty() ? options.kind : started_as.empty() ? before.interface.kind : started_as;
    if (options.kind.empty() && !program_of(kind))
        throw Error(Errc::not_found, drone + " is a " + kind + ", and there is no program hive-" + kind,
                    "say what the new one is, if a Python file: --kind FILE.py, or kind=\"FILE.py\" in Python");
    const auto next = interface_of(kind);
    for (const auto& [name, value] : options.parameters.items())
        before.parameters.erase(name);
    require_fit(application, before, next);
    require_forgettable(before, options);
    if (home.succession(place.drone))
        throw Error(Errc::name_taken, place.drone + " is being replaced already");
    for (int attempt = 1; attempt <= most_attempts; ++attempt)
        if (Successor successor(application, home, place.drone, kind, options, before.status.pid); successor.await())
            return {.drone = place.drone,
                    .kind = next.kind,
                    .pid = successor.pid(),
                    .before = before.status.pid,
                    .log = home.path(place.drone, ".log")};
    throw Error(Errc::failed, drone + " has been replaced " + std::to_string(most_attempts)
                                  + " times by a process that died at once");
}

}  // namespace hive
