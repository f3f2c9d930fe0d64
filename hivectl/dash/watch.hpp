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

/// Two threads: one queries all drones and runs Graphviz when drones or connections have changed, the other explains
/// the last two answers of each. Each has its own application, so a drone that does not answer delays only the next
/// query.
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
    /// @return  the pause before the next turn
    using Turn = std::chrono::milliseconds (Watch::*)(hive::Application&);
    void run(Turn turn);
    bool wait_for_looker(Time not_before);
    std::chrono::milliseconds look(hive::Application& application);
    std::chrono::milliseconds explain(hive::Application& application);
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
    struct Query {
        std::vector<hive::StatusAnswer> answers;  ///< with the connections of pages
        Time at;
    };
    std::shared_ptr<const Query> before_, last_;
    std::shared_ptr<const Query> explained_;  ///< for the explaining thread
    // For the querying thread:
    std::deque<Look> looks_;
    std::map<std::string, Past> past_;
    std::string drawn_;
    std::future<void> drawer_;
    std::thread looker_, explainer_;
};

}  // namespace hivectl::dash
