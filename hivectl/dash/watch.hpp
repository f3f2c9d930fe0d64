// Queries the swarm every second while a page is open.
#pragma once

#include "snapshot.hpp"

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>

namespace hivectl::dash {

/// Two threads: one queries all drones and runs Graphviz when drones or connections have changed, the other runs
/// explain. Each has its own application, so a drone that does not answer delays only the next query.
class Watch {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// The graph as SVG.
    struct Drawing {
        std::uint64_t version = 0;  ///< 0: there is none yet
        std::string svg{};
        std::string problem{};  ///< why there is none: Graphviz is missing
    };

    /// @param changed  called on its threads for a new snapshot
    Watch(std::filesystem::path home, std::chrono::milliseconds timeout, std::function<void()> changed);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    /// Null until the first query is done. Pages call it repeatedly. From any thread; never blocks.
    std::shared_ptr<const Snapshot> newest(Time now);
    [[nodiscard]] std::shared_ptr<const Drawing> drawing() const;

private:
    void run(void (Watch::*turn)(hive::Application&), std::chrono::milliseconds every);
    bool wait_for_looker(Time not_before);
    void look(hive::Application& application);
    void explain(hive::Application& application);
    void draw(const hive::SwarmGraph& graph);

    const std::filesystem::path home_;
    const std::chrono::milliseconds timeout_;
    const std::function<void()> changed_;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    bool ending_ = false;
    Time looked_{};  ///< time of the last request of a page
    std::shared_ptr<const Snapshot> newest_;
    std::shared_ptr<const Drawing> drawing_ = std::make_shared<Drawing>();
    hive::Json worst_;  ///< the result of explain
    // For the querying thread:
    std::deque<Look> looks_;
    std::map<std::string, Past> past_;
    std::string drawn_;
    std::future<void> drawer_;
    std::thread looker_, explainer_;
};

}  // namespace hivectl::dash
