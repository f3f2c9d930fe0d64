// A collector that stays for a whole round: a thread takes results and exceptions as they come.
#pragma once

#include "model.hpp"

#include <swarm.hpp>

#include <mutex>
#include <thread>

namespace hive::mixtures {

class Collecting {
public:
    /// All drones must run.
    Collecting(const test::Swarm& swarm, const Topology& topology);

    /// What has come since the last call, in the order of its coming.
    std::vector<Outcome> take();
    [[nodiscard]] CollectCounts counts() const;
    /// Once everything has come after an end of the source: what is missing.
    [[nodiscard]] std::optional<std::string> ended() const;

private:
    void run(const std::stop_token& ending);

    Application application_, hearing_;  ///< two, since an edge is known by the name of its receiver
    std::unique_ptr<Collector> results_, exceptions_;
    mutable std::mutex mutex_;
    std::vector<Outcome> came_;
    CollectCounts counts_;
    std::optional<std::string> ended_;
    std::jthread thread_;  // the last: it uses all the others
};

}  // namespace hive::mixtures
