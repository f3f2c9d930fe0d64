// A round on real drones: processes, signals and the calls of an application.
#pragma once

#include "branch.hpp"
#include "collecting.hpp"
#include "command.hpp"
#include "extras.hpp"
#include "numbering.hpp"
#include "round.hpp"

#include <swarm.hpp>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <thread>

namespace hive::mixtures {

class Running final : public Ground {
public:
    /// Starts all drones, and connects none.
    Running(const Topology& topology, const Extras& extras);

    [[nodiscard]] Clock::time_point now() const override { return Clock::now(); }
    void sleep(std::chrono::microseconds time) override { std::this_thread::sleep_for(time); }
    void at_once(const std::function<void()>& one, const std::function<void()>& other) override;
    [[nodiscard]] std::chrono::milliseconds stillness() const override;
    [[nodiscard]] std::chrono::milliseconds longest_settling() const override;
    [[nodiscard]] std::chrono::microseconds age() const override
    {
        return std::chrono::duration_cast<std::chrono::microseconds>(now() - begun_);
    }
    void connect(const Edge& edge) override;
    bool begin(const std::vector<Edge>& edges) override;
    std::vector<ConnectAnswer> connect(const std::vector<SwarmConnection>& connections,
                                       std::chrono::milliseconds timeout) override;
    void perform(const Step& step) override;
    [[nodiscard]] std::int64_t fed() const override { return fed_; }
    Told set(const Change& change) override;
    [[nodiscard]] std::vector<std::string> answering() const override;
    Statuses statuses() override;
    Settings settings() override;
    std::int64_t count() override;
    [[nodiscard]] const std::map<std::string, int>& born() const override { return born_; }
    std::vector<Outcome> outcomes() override { return numbering_.numbered(collecting_->take()); }
    CollectCounts collected() override { return collecting_->counts(); }
    std::optional<std::string> ended() override { return collecting_->ended(); }
    [[nodiscard]] std::int64_t collectors() const override { return command_ ? 2 : 1; }
    std::optional<Printed> end_source() override;
    std::vector<std::string> fallen() override;
    std::vector<std::string> end() override;
    std::vector<Received> received() override;

private:
    void feed(int events);
    [[nodiscard]] std::vector<std::string> first_settings(const std::string& drone) const;
    void start(const std::string& drone, bool remembers);
    void up(bool halted);
    void down(std::vector<std::string>& left);

    const Clock::time_point begun_ = now();
    Topology topology_;
    Extras extras_;
    test::Swarm swarm_;
    std::map<std::string, test::Process> processes_;
    std::map<std::string, test::Clock::time_point> frozen_;
    std::set<std::string> killed_;
    std::map<std::string, int> born_;
    int starts_ = 0;
    Application application_{swarm_.application()};
    std::int64_t fed_ = 1;
    Numbering numbering_;
    std::optional<Collecting> collecting_;
    std::optional<Command> command_;
    std::optional<Branch> branch_;
    std::jthread branching_;  // the last: it uses the branch
};

/// A round with its beginning and its end; also what is left of it is a problem.
Played play(const Plan& plan);

}  // namespace hive::mixtures
