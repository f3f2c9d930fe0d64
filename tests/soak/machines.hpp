// The ground of a soak: real drones on three machines of a lab, and a collector and an operator on a fourth.
#pragma once

#include "faults.hpp"
#include "growth.hpp"

#include <collecting.hpp>
#include <ground.hpp>
#include <lab.hpp>
#include <network_space.hpp>

#include <atomic>
#include <memory>

namespace hive::soak {

/// What has come in all.
struct Came {
    std::int64_t results = 0, exceptions = 0;
    std::map<std::string, std::int64_t> failures;  ///< exceptions of the code of a drone, since its start
    std::map<std::string, std::int64_t> given_up;  ///< of events that it gave up, likewise
};

/// False for a process that has exited, even before it was reaped.
bool runs(pid_t pid);

class Machines final : public mixtures::Ground {
public:
    /// Starts all drones, and connects none. Needs missing_for_lab() to be empty. The calling thread enters the network
    /// of the fourth machine.
    explicit Machines(const Swarm& swarm);

    [[nodiscard]] Clock::time_point now() const override { return Clock::now(); }
    void sleep(std::chrono::microseconds time) override;
    void at_once(const std::function<void()>& one, const std::function<void()>& other) override;
    /// Wider than what is promised: all drones and the tests share the processors of one machine.
    [[nodiscard]] std::chrono::milliseconds stillness() const override { return std::chrono::seconds(4); }
    [[nodiscard]] std::chrono::milliseconds longest_settling() const override { return std::chrono::minutes(2); }
    [[nodiscard]] std::chrono::microseconds age() const override
    {
        return std::chrono::duration_cast<std::chrono::microseconds>(now() - begun_);
    }
    /// One clock for all machines, but its offset between two is measured over a network that fails.
    [[nodiscard]] std::optional<std::chrono::microseconds> age_error() const override
    {
        return std::chrono::seconds(15);
    }
    /// In the home, and on the network.
    [[nodiscard]] std::int64_t max_places() const override { return 2; }
    /// Also shortly after a failure of the network: a peer that was declared dead has to connect again.
    [[nodiscard]] bool all_hear() const override;
    void connect(const mixtures::Edge& edge) override;
    std::vector<ConnectAnswer> connect(const std::vector<SwarmConnection>& connections,
                                       std::chrono::milliseconds timeout) override;
    void perform(const mixtures::Step& step) override;
    [[nodiscard]] std::int64_t fed() const override { return fed_; }
    mixtures::Told set(const mixtures::Change& change) override;
    [[nodiscard]] std::vector<std::string> answering() const override;
    /// Asked on their machines, so that a network that fails matters not.
    mixtures::Statuses statuses() override;
    mixtures::Settings settings() override;
    std::int64_t count() override;
    [[nodiscard]] const std::map<std::string, int>& born() const override { return born_; }
    std::vector<mixtures::Outcome> outcomes() override;
    CollectCounts collected() override { return collecting_->counts(); }
    std::vector<std::string> fallen() override;
    std::vector<std::string> end() override;

    [[nodiscard]] const Came& came() const { return came_; }
    /// The number of the newest event of a run of the source that has come.
    [[nodiscard]] std::int64_t newest_of(std::int64_t epoch) const
    {
        const auto found = newest_.find(epoch);
        return found == newest_.end() ? 0 : found->second;
    }
    /// Of the drones that run.
    [[nodiscard]] Usages usages() const;
    /// Of the fourth machine's hivectl.
    [[nodiscard]] test::Finished hivectl(const std::string& words) const { return lab_.shell("hivectl " + words); }
    /// Copies all logs there.
    void save_logs(const std::filesystem::path& directory) const;

private:
    [[nodiscard]] std::size_t machine_of(const std::string& drone) const { return number_of(swarm_.places.at(drone)); }
    [[nodiscard]] static std::size_t number_of(const std::string& machine);
    [[nodiscard]] Application& local(const std::string& drone) { return *local_.at(machine_of(drone)); }
    void start(const std::string& drone, bool remembers);
    void start_again(const std::string& drone);
    void forget_many();
    void begun(const std::string& drone);
    void feed(int events);
    void fail(const std::string& drone);
    void network(const mixtures::Step& step);

    const Clock::time_point begun_ = now();
    Swarm swarm_;
    test::Lab lab_;
    test::NetworkVisit on_laptop_;                     ///< over before the lab ends all that is inside
    std::vector<std::unique_ptr<Application>> local_;  ///< one on each machine
    std::unique_ptr<Application> application_;
    std::optional<mixtures::Collecting> collecting_;
    std::map<std::string, pid_t> pids_;  ///< of drones that were not killed or stopped
    std::set<std::string> killed_;
    std::map<std::string, Clock::time_point> frozen_;
    int network_failures_ = 0;
    Clock::time_point network_whole_ = now();
    std::map<std::string, int> born_;
    int starts_ = 0, fails_ = 0;
    std::int64_t fed_ = 1;
    Came came_;
    std::map<std::int64_t, std::int64_t> newest_;  ///< by epoch of the source
};

}  // namespace hive::soak
