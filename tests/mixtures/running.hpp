// The drones of a round as processes, and what is done to them.
#pragma once

#include "plan.hpp"
#include "status_of.hpp"
#include "values.hpp"

#include <swarm.hpp>

#include <set>

namespace hive::mixtures {

class Running {
public:
    /// Starts all drones, and connects none.
    explicit Running(const Topology& topology);

    [[nodiscard]] const test::Swarm& swarm() const { return swarm_; }
    [[nodiscard]] Application& application() { return application_; }
    void connect(const Edge& edge);
    /// All steps but the sets. Throws what a drone answers.
    void perform(const Step& step);
    /// Raises the number of events that the source may make.
    void feed(int events);
    [[nodiscard]] std::int64_t fed() const { return fed_; }
    Told set(const Change& change);

    /// Of the drones that can answer.
    Statuses statuses();
    /// Parameters of the workers that can answer.
    Settings settings();
    [[nodiscard]] std::vector<std::string> answering() const;
    /// Numbers the latest starts of the drones; all begin with 0.
    [[nodiscard]] const std::map<std::string, int>& born() const { return born_; }
    /// Drones that have ended by themselves, which none may.
    std::vector<std::string> fallen();
    /// Ends all by order; says what is left of them.
    std::vector<std::string> end();

    static Setting first_setting() { return {.work_ms = 4, .most_ms = 600'000}; }

private:
    void start(const std::string& drone, bool remembers);

    Topology topology_;
    test::Swarm swarm_;
    std::map<std::string, test::Process> processes_;
    std::map<std::string, test::Clock::time_point> frozen_;
    std::set<std::string> killed_;
    std::map<std::string, int> born_;
    int starts_ = 0;
    Application application_{swarm_.application()};
    std::int64_t fed_ = 1;
};

}  // namespace hive::mixtures
