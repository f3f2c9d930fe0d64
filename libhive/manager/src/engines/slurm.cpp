// Runs each drone as a step of the Slurm allocation in which this program runs.
#include "engine.hpp"

#include "../last_line.hpp"
#include "../running_command.hpp"
#include "reachable.hpp"

#include <hive/process.hpp>
#include <hive/program.hpp>
#include <hive/transport/listen_address.hpp>

#include <algorithm>
#include <list>
#include <map>
#include <set>
#include <sstream>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hive {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t steps_at_once = 16;  ///< started and not yet reachable
constexpr auto slurm_timeout = 10s;        ///< per command of Slurm
constexpr auto exit_timeout = 5s;          ///< for steps after a signal

/// The range of drones' ports on a node, below the system's ephemeral ports. A drone gets the same port each time, so
/// that one left behind by a killed `up` is found; if another program has the port, it gets the next.
constexpr int first_port = 12'000, ports = 20'000, port_tries = 3;

int port_of(const std::string& job, const std::string& drone, int attempt)
{
    std::uint32_t hash = 2'166'136'261U;  // FNV-1a: the same in every process
    for (const unsigned char c : job + "." + drone)
        hash = (hash ^ c) * 16'777'619U;
    return first_port + static_cast<int>((hash + static_cast<std::uint32_t>(attempt)) % ports);
}

std::string variable(const std::string& name)
{
    const char* const value = std::getenv(name.c_str());
    return value ? value : "";
}

/// The number of components of a heterogeneous job, each with its own nodes and id; 0: the job is not heterogeneous.
int components() { return std::atoi(variable("SLURM_HET_SIZE").c_str()); }

bool is_of_this_job(const std::string& step)
{
    bool is = step.starts_with(variable("SLURM_JOB_ID") + ".");
    for (int i = 0; i < components(); ++i)
        is = is || step.starts_with(variable("SLURM_JOB_ID_HET_GROUP_" + std::to_string(i)) + ".");
    return is;
}

class SlurmEngine final : public Engine {
public:
    SlurmEngine(const Json& settings, std::string node, std::filesystem::path home)
        : node_(std::move(node)), home_(std::move(home)), job_(variable("SLURM_JOB_ID"))
    {
        if (settings.is_object())
            for (const auto& option : settings.value("options", Json::array()))
                options_.push_back(option.get<std::string>());
    }

    void require_usable() const override;
    void begin(std::vector<SwarmDrone> drones, Clock::time_point until) override;
    std::vector<Report> poll() override;
    [[nodiscard]] std::vector<int> descriptors() override;
    void adopt(const std::vector<std::string>& drones) override { adopted_.insert(drones.begin(), drones.end()); }
    void look_again(const std::string& drone, const Error& why) override;
    std::vector<SwarmFailure> stop(const std::vector<std::string>& drones, Clock::time_point until) override;

private:
    struct Step {
        SwarmDrone drone;
        int port;
        BackgroundProcess process;
        bool met = false;  ///< reported
    };

    bool find_node(std::vector<Report>& reports);
    std::optional<std::string> query(const std::vector<std::string>& command, const std::string& failure);
    void start(const SwarmDrone& drone, std::vector<Report>& reports);
    [[nodiscard]] std::vector<std::string> words_of(SwarmDrone drone, int port) const;
    [[nodiscard]] int free_port(const SwarmDrone& drone) const;
    [[nodiscard]] std::optional<Report> look(Step& step) const;
    [[nodiscard]] Report place_of(const std::string& drone, int port) const;
    [[nodiscard]] std::vector<std::string> steps_named(const std::vector<std::string>& drones) const;
    [[nodiscard]] std::vector<std::string> left_of(const std::vector<std::string>& drones);

    std::string node_;
    std::filesystem::path home_;
    std::string job_;
    std::vector<std::string> options_;
    std::string address_, component_;  ///< of the node; empty: not known yet
    std::optional<RunningCommand> asking_;
    std::list<Step> steps_;
    std::set<std::string> adopted_;
};

/// Of "NodeName=n1 ... NodeAddr=10.0.0.7 ...".
std::string address_in(const std::string& text)
{
    constexpr std::string_view key = "NodeAddr=";
    const auto begin = text.find(key);
    return begin == std::string::npos
               ? ""
               : text.substr(begin + key.size(), text.find_first_of(" \n", begin) - begin - key.size());
}

void SlurmEngine::require_usable() const
{
    if (job_.empty())
        throw Error(Errc::refused, "the drones on " + node_ + " need a Slurm allocation, and this shell has none",
                    "run hivectl up inside salloc or an sbatch script");
}

void SlurmEngine::begin(std::vector<SwarmDrone> drones, Clock::time_point until)
{
    require_usable();
    Engine::begin(std::move(drones), until);
}

std::vector<Engine::Report> SlurmEngine::poll()
{
    std::vector<Report> reports;
    if (!find_node(reports))
        return reports;
    for (auto& step : steps_)
        if (auto report = step.met ? std::nullopt : look(step)) {
            step.met = true;
            step.process.let_go();
            reports.push_back(*std::move(report));
        }
    auto not_met = std::ranges::count(steps_, false, &Step::met);
    for (; !waiting_.empty() && not_met < static_cast<std::ptrdiff_t>(steps_at_once); waiting_.pop_front(), ++not_met)
        start(waiting_.front(), reports);
    return reports;
}

void SlurmEngine::look_again(const std::string& drone, const Error&)
{
    for (auto& step : steps_)
        if (step.drone.name == drone)
            step.met = false;
}

std::vector<int> SlurmEngine::descriptors()
{
    auto all = asking_ ? asking_->descriptors() : std::vector<int>();
    for (auto& step : steps_)
        if (!step.met)
            all.push_back(step.process.descriptor());
    return all;
}

/// The output of a command of Slurm; nothing while it runs. Throws `failure`.
std::optional<std::string> SlurmEngine::query(const std::vector<std::string>& command, const std::string& failure)
{
    if (!asking_)
        asking_.emplace(command, slurm_timeout);
    const auto result = asking_->poll();
    if (!result)
        return std::nullopt;
    asking_.reset();
    if (result->late || result->exit_code != 0)
        throw Error(Errc::not_found, failure + ": " + last_line(result->out + result->err));
    return result->out;
}

/// Queries Slurm for the node's address and its component of the job. False until they are known.
bool SlurmEngine::find_node(std::vector<Report>& reports)
try {
    const auto no_node = "Slurm has no node " + node_;
    if (address_.empty() && !waiting_.empty()) {
        const auto told = query({"scontrol", "-o", "show", "node", node_}, no_node);
        if (!told)
            return false;
        address_ = address_in(*told);
        if (address_.empty())
            throw Error(Errc::not_found, no_node, "see them: sinfo -N");
    }
    if (components() > 0 && component_.empty() && !waiting_.empty()) {
        const auto failure = "no component of the job " + job_ + " has the node " + node_;
        const auto told =
            query({"squeue", "--jobs=" + job_, "--nodelist=" + node_, "--noheader", "--format=%i"}, failure);
        if (!told)
            return false;
        const auto plus = told->find('+');  // of "JOB+1"
        if (plus == std::string::npos)
            throw Error(Errc::not_found, failure, "see them: squeue --jobs=" + job_);
        component_ = told->substr(plus + 1, told->find_first_not_of("0123456789", plus + 1) - plus - 1);
    }
    return true;
} catch (const Error& error) {
    for (; !waiting_.empty(); waiting_.pop_front())
        reports.push_back({waiting_.front().name, error});
    return false;
}

void SlurmEngine::start(const SwarmDrone& drone, std::vector<Report>& reports)
try {
    const int port = free_port(drone);
    const auto words = words_of(drone, port);
    // A home per node: in a home shared by the nodes, sockets and locks of one would not work on the others.
    const auto home = "/tmp/hive-" + std::to_string(::getuid()) + "-" + job_ + "-" + node_;
    auto environment = command_of(drone.kind).environment;
    environment.push_back("HIVE_HOME=" + home);
    const auto log = home_ / (drone.name + ".log");
    steps_.push_back(
        {drone, port, BackgroundProcess("/usr/bin/env", words, environment, log, BackgroundProcess::Life::own)});
} catch (const Error& error) {
    reports.push_back({drone.name, error});
}

std::vector<std::string> SlurmEngine::words_of(SwarmDrone drone, int port) const
{
    auto listen = transport::listen_address(drone.listen.empty() ? "tcp://0.0.0.0" : drone.listen);
    listen.port = static_cast<std::uint16_t>(port);
    drone.listen = to_text(listen);
    const auto command = command_of(drone.kind);
    std::vector<std::string> words{"srun", "--jobid=" + job_, "--nodes=1", "--ntasks=1"};
    words.insert(words.end(), {"--nodelist=" + node_, "--job-name=" + drone.name, "--input=none", "--quiet"});
    const auto chosen = [](const std::string& option) { return option.starts_with("--het-group"); };
    if (!component_.empty() && std::ranges::none_of(options_, chosen))
        words.push_back("--het-group=" + component_);
    words.insert(words.end(), options_.begin(), options_.end());
    std::ranges::move(step_amounts(drone), std::back_inserter(words));
    words.push_back(command.program.string());
    words.insert(words.end(), command.arguments.begin(), command.arguments.end());
    std::ranges::move(arguments_of(drone), std::back_inserter(words));
    return words;
}

/// The port of "tcp://HOST:PORT", if the plan has one, or a free one.
int SlurmEngine::free_port(const SwarmDrone& drone) const
{
    if (const int port = drone.listen.empty() ? 0 : transport::listen_address(drone.listen).port; port > 0)
        return port;
    const auto given = [&](int port) { return std::ranges::find(steps_, port, &Step::port) != steps_.end(); };
    for (int attempt = 0; attempt < port_tries; ++attempt)
        if (const int port = port_of(job_, drone.name, attempt); !given(port) && !reachable(address_, port))
            return port;
    throw Error(Errc::name_taken, "other programs on " + node_ + " have the ports that " + drone.name + " would take");
}

std::optional<Engine::Report> SlurmEngine::look(Step& step) const
{
    const auto& name = step.drone.name;
    const auto status = step.process.ended();
    if (!status)
        return reachable(address_, step.port) ? std::optional(place_of(name, step.port)) : std::nullopt;
    const bool refused = WIFEXITED(*status) && WEXITSTATUS(*status) == info(Errc::name_taken).exit_code;
    if (refused)
        for (int attempt = 0; attempt < port_tries; ++attempt)
            if (const int port = port_of(job_, name, attempt); reachable(address_, port))
                return place_of(name, port);  // a killed hivectl had started it
    return Report{name, not_ready(name, *status, step.process.last_words())};
}

Engine::Report SlurmEngine::place_of(const std::string& drone, int port) const
{
    const transport::Address at{transport::Address::Scheme::tcp, address_, static_cast<std::uint16_t>(port)};
    return {drone, Started{.place = {.drone = drone, .host = node_, .address = to_text(at)}}};
}

/// "JOB.STEP" of each, in the current job, or in any job outside of an allocation.
std::vector<std::string> SlurmEngine::steps_named(const std::vector<std::string>& drones) const
{
    const auto listed = run_command({"squeue", "--steps", "--me", "--noheader", "--format=%i %N %j"}, slurm_timeout);
    if (listed.late || listed.exit_code != 0)
        throw Error(Errc::unreachable, "Slurm does not say which steps run: " + last_line(listed.err),
                    "try it: squeue");
    std::vector<std::string> ids;
    std::istringstream lines(listed.out);
    for (std::string id, node, name; lines >> id >> node && std::getline(lines >> std::ws, name);)
        if ((job_.empty() || is_of_this_job(id)) && node == node_
            && std::ranges::find(drones, name.substr(0, name.find_last_not_of(' ') + 1)) != drones.end())
            ids.push_back(id);
    return ids;
}

/// Signals the step: on SIGTERM a drone discards its saved state, while srun would kill it.
std::vector<SwarmFailure> SlurmEngine::stop(const std::vector<std::string>& drones, Clock::time_point)
{
    const auto meant = [&](const std::string& name) { return std::ranges::find(drones, name) != drones.end(); };
    forget_waiting(drones);
    std::vector<std::string> ours;
    std::ranges::copy_if(adopted_, std::back_inserter(ours), meant);
    for (auto& step : steps_)
        if (meant(step.drone.name) && !step.process.ended())
            ours.push_back(step.drone.name);
    auto ids = ours.empty() ? ours : steps_named(ours);
    for (const auto* signal : {"--signal=TERM", "--signal=KILL"})
        if (!ids.empty()) {
            ids.insert(ids.begin(), {"scancel", signal});
            run_command(ids, slurm_timeout);
            ids = left_of(ours);
        }
    std::erase_if(steps_, [&](Step& step) {
        if (meant(step.drone.name))
            step.process.end();
        return meant(step.drone.name);
    });
    std::vector<SwarmFailure> remains;
    if (!ids.empty())
        for (const auto& name : ours)
            remains.push_back({name, Error(Errc::timeout, "the step of " + name + " on " + node_ + " has not ended")});
    return remains;
}

/// The steps that have not ended in time. For those of an earlier process, only Slurm has the state, and must be
/// polled.
std::vector<std::string> SlurmEngine::left_of(const std::vector<std::string>& drones)
{
    const auto until = Clock::now() + exit_timeout;
    for (auto& step : steps_)
        if (std::ranges::find(drones, step.drone.name) != drones.end())
            step.process.await_end(until);
    auto ids = steps_named(drones);
    for (; !ids.empty() && Clock::now() < until; ids = steps_named(drones))
        ::poll(nullptr, 0, 200);
    return ids;
}

}  // namespace

std::vector<std::string> step_amounts(const SwarmDrone& drone)
{
    std::vector<std::string> options{drone.cpus > 0 || drone.gpus > 0 ? "--exact" : "--overlap"};
    if (drone.cpus > 0)
        options.push_back("--cpus-per-task=" + std::to_string(drone.cpus));
    if (drone.memory_mib > 0)
        options.push_back("--mem=" + std::to_string(drone.memory_mib) + "M");
    else if (options.front() == "--exact")
        options.emplace_back("--mem=0");  // otherwise it takes the memory of the allocation from the other steps
    if (drone.gpus > 0)
        options.push_back("--gres=gpu:" + std::to_string(drone.gpus));
    return options;
}

std::unique_ptr<Engine> make_slurm_engine(const Json& settings, const std::string& node,
                                          const std::filesystem::path& home)
{
    return std::make_unique<SlurmEngine>(settings, node, home);
}

}  // namespace hive
