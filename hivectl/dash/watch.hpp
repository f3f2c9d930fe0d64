// Looks at the swarm each second, as long as a page is open.
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

/// Two threads: one asks all drones and has Graphviz draw the graph when drones or connections have changed, the other
/// asks what holds them up. Each has an application of its own, so a drone that does not answer delays nothing but the
/// next look.
class Watch {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// The graph as SVG.
    struct Drawing {
        std::uint64_t version = 0;  ///< 0: there is none yet
        std::string svg{};
        std::string problem{};  ///< why there is none: Graphviz is missing
    };

    /// @param changed  called from its threads when there is a new snapshot
    Watch(std::filesystem::path home, std::chrono::milliseconds timeout, std::function<void()> changed);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    /// Null until the first look is done. A page calls this again and again. From any thread; never waits.
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
    Time looked_{};  ///< when a page asked last
    std::shared_ptr<const Snapshot> newest_;
    std::shared_ptr<const Drawing> drawing_ = std::make_shared<Drawing>();
    hive::Json worst_;  ///< what explain says
    // Of the thread that looks:
    std::deque<Look> looks_;
    std::map<std::string, Past> past_;
    std::string drawn_;
    std::future<void> drawer_;
    std::thread looker_, explainer_;
};

}  // namespace hivectl::dash
