// A round in the simulated world: its drones are threads with stacks of their own, its orders are calls of an
// application, and its status is read directly.
#pragma once

#include "deadline.hpp"
#include "links.hpp"
#include "world.hpp"

#include <branch.hpp>
#include <ground.hpp>

#include <hive/application.hpp>
#include <hive/embedded_drone.hpp>

#include <map>
#include <set>
#include <tuple>

namespace hive::simulation {

using mixtures::Outcome;

/// Prints events if requested.
class Trace {
public:
    explicit Trace(bool wanted) : wanted_(wanted) {}
    void line(const std::string& who, const std::string& what) const;

private:
    bool wanted_;
};

inline constexpr auto short_timeout = std::chrono::seconds(1);
Application::Options application_named(const std::string& name,
                                       std::chrono::milliseconds timeout = Application::Options().timeout);

/// The drones and applications that exist during a whole round.
std::set<std::string> peers(const mixtures::Topology& topology);

/// Made and used by a thread of the world.
class SimulatedGround final : public mixtures::Ground {
public:
    SimulatedGround(World& world, const mixtures::Plan& plan, const Trace& trace);
    ~SimulatedGround() override;

    [[nodiscard]] Clock::time_point now() const override { return world_.now(); }
    void sleep(std::chrono::microseconds time) override { world_.sleep(time); }
    void at_once(const std::function<void()>& one, const std::function<void()>& other) override;
    /// An ordered collector waits 30 s for each exception that it could not hear.
    [[nodiscard]] std::chrono::milliseconds longest_settling() const override { return std::chrono::minutes(5); }
    [[nodiscard]] std::chrono::microseconds age() const override
    {
        return std::chrono::duration_cast<std::chrono::microseconds>(world_.age());
    }
    [[nodiscard]] std::optional<std::chrono::microseconds> age_error() const override;
    [[nodiscard]] bool all_hear() const override
    {
        return world_.now() > silent_until_ + std::chrono::milliseconds(50);
    }
    [[nodiscard]] std::chrono::milliseconds pace() const override { return std::chrono::milliseconds(50); }
    [[nodiscard]] bool punctual() const override { return true; }
    [[nodiscard]] bool was_cut(const std::string& drone, const std::string& peer) const override
    {
        return cut_.contains({drone, peer}) || cut_.contains({peer, drone});
    }
    void connect(const mixtures::Edge& edge) override;
    std::vector<ConnectAnswer> connect(const std::vector<SwarmConnection>& connections,
                                       std::chrono::milliseconds timeout) override;
    void perform(const mixtures::Step& step) override;
    [[nodiscard]] std::int64_t fed() const override { return fed_; }
    mixtures::Told set(const mixtures::Change& change) override;
    [[nodiscard]] std::vector<std::string> answering() const override;
    mixtures::Statuses statuses() override;
    mixtures::Settings settings() override;
    std::int64_t count() override;
    [[nodiscard]] const std::map<std::string, int>& born() const override { return born_; }
    std::vector<Outcome> outcomes() override { return std::exchange(collected_.came, {}); }
    CollectCounts collected() override { return collected_.counts; }
    std::optional<std::string> ended() override { return collected_.ended; }
    std::vector<std::string> complaints() override;
    std::vector<std::string> fallen() override;
    std::vector<std::string> end() override;
    std::vector<mixtures::Received> received() override;

private:
    /// A process of a drone.
    struct Running {
        Process* process = nullptr;
        Drone* drone = nullptr;  ///< while it exists
        bool ready = false, stopped = false;
        std::int64_t epoch = 0;
    };
    /// The code of a drone fails at this one of the events that come from now on.
    struct Failing {
        std::uint64_t events;
        mixtures::Failure how;
        std::chrono::milliseconds time;
    };
    using RunningPtr = std::shared_ptr<Running>;
    struct Collected {
        std::vector<Outcome> came;
        CollectCounts counts;
        std::optional<std::string> ended;
        Process* process = nullptr;
        bool begun = false, ending = false;
    };

    void start(const std::string& drone, bool remembers, std::optional<int> writes = {});
    void restart(const std::string& drone);
    void forget(const mixtures::Step& step);
    void kill(const std::string& drone);
    void die_while_writing(Process& process);
    [[nodiscard]] bool has(const std::string& fault) const { return faults_.contains(fault); }
    void live(const std::string& name, EmbeddedDrone& embedded, const RunningPtr& running);
    [[nodiscard]] std::string kind_of(const std::string& drone, bool remembers) const;
    [[nodiscard]] Log log_of(const std::string& drone, RunningPtr running = {});
    void fail(const mixtures::Step& step);
    [[nodiscard]] bool fails_now(const std::string& drone);
    void on_work(const std::string& drone, const Event& event);
    [[nodiscard]] std::size_t body_size();
    void part(std::chrono::milliseconds time, int way);
    void replace(const mixtures::Step& step);
    Process& replace_in_background(const std::string& drone, const std::string& kind = {});
    void await_successors();
    Process& start_program(const std::vector<std::string>& words);
    void took_name(const std::string& drone, const RunningPtr& running);
    [[nodiscard]] std::vector<Endpoint> ends() const;
    void collect();
    void collect_branch();
    [[nodiscard]] std::pair<std::int64_t, std::int64_t> place_of(const Identity& identity) const;
    void take(const Event& event, bool failed);
    void check_age(const Event& event);
    [[nodiscard]] int machine_of(const std::string& drone) const;
    void perform_now(const mixtures::Step& step);
    void feed(int events);
    void stop(const mixtures::Step& step);
    bool failed_by(const mixtures::Step& step, mixtures::Failure how, std::chrono::milliseconds time);
    void freeze(const std::string& drone);
    void ask_impatiently(const std::string& drone);
    void thaw(const std::string& drone, std::chrono::milliseconds least);
    void part_clocks();
    void lie_sometimes();
    Process& spawn_liar(const std::string& name, std::function<void()> main);
    void receive_as_liar(const std::string& name, const std::string& from);
    void send_as_liar(const std::string& name);
    void listen_to_liar(const std::string& name, const std::string& liar);
    void cut_sometimes();
    [[nodiscard]] std::shared_ptr<void> unplug_sometimes();
    void plug_in(std::shared_ptr<void>&& unplugged);
    void set_clock_sometimes();
    void silence_sometimes();
    void watch_sometimes();
    void watch_until_the_end(const std::string& name);
    /// Can all drones answer at once, and ask those from which they receive?
    [[nodiscard]] bool all_answer();
    void wait_until_heard();
    /// Sleeps until then.
    void until(const std::function<bool()>& condition);

    World& world_;
    const mixtures::Topology topology_;
    const std::set<std::string> faults_;
    const bool freezes_;                   ///< some drone is frozen
    std::map<std::string, int> machines_;  ///< of drones; who is not here is on machine 0
    std::vector<std::string> wrong_ages_;
    const Trace& trace_;
    std::map<std::string, RunningPtr> running_;                   ///< the process that has the name
    std::vector<std::pair<std::string, RunningPtr>> successors_;  ///< that wait for a name, or did
    std::map<std::string, Time> frozen_;
    std::set<std::string> killed_;
    std::map<std::string, int> born_;
    int starts_ = 0;
    /// Epoch of the source's run, and number in it, by what an event says.
    std::map<std::pair<std::int64_t, std::int64_t>, std::pair<std::int64_t, std::int64_t>> captures_;
    std::vector<std::string> wrong_ends_;
    std::vector<std::string> wrong_owners_, wrong_bodies_;
    std::map<std::string, Failing> failing_;
    /// An event for which code of a plain drone or of a stage that shares is called: does it throw, each time?
    std::map<std::tuple<std::string, std::int64_t, std::int64_t, std::int64_t>, bool> throws_;
    int disturbances_ = 0;  ///< faults so far, and orders that are not for the source
    bool stops_ = false;    ///< a drone is being stopped
    int liars_ = 0, watchers_ = 0, callers_ = 0;
    std::vector<Process*> guests_;  ///< processes outside of the round: liars, their receivers, and watchers
    Process* watching_ = nullptr;   ///< of them, the last watcher
    bool ending_ = false;
    std::vector<std::string> fallen_;  ///< of them
    std::int64_t fed_ = 1;
    Collected collected_;
    std::optional<mixtures::Branch> branch_;
    Process* branching_ = nullptr;  ///< collects it
    Links links_;
    std::set<std::pair<std::string, std::string>> cut_;  ///< between two machines
    Time silent_until_{}, reachable_from_{};
    Deadline calls_, waits_, impatient_calls_, replaces_;
    std::optional<Application> application_, impatient_;  ///< the latter asks drones that cannot answer
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace hive::simulation
