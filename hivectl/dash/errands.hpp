// Runs requests of the page to drones on their own threads: each errand has a deadline, and none waits for another.
#pragma once

#include <hive/application.hpp>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace hivectl::dash {

class Errands {
public:
    /// The work. Its result is for the page; an exception becomes {"error": {"code", "text", "advice"}}.
    using Work = std::function<hive::Json(hive::Application&)>;
    static constexpr std::size_t max_threads = 32;  ///< further errands are queued
    static constexpr std::size_t max_waiting = 64;

    /// @param done  called on its threads when an errand is done
    Errands(std::filesystem::path home, std::chrono::milliseconds timeout, std::function<void()> done);
    ~Errands();
    Errands(const Errands&) = delete;
    Errands& operator=(const Errands&) = delete;

    /// The number of the errand, from 1. 0: the queue is full.
    std::uint64_t begin(Work work);
    /// The result, once. Nothing: not done yet.
    std::optional<hive::Json> take(std::uint64_t errand);

private:
    void run();
    [[nodiscard]] bool ending() const;

    const std::filesystem::path home_;
    const std::chrono::milliseconds timeout_;
    const std::function<void()> done_;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    bool ending_ = false;
    std::size_t idle_ = 0;  ///< threads that wait for an errand
    std::uint64_t begun_ = 0;
    std::deque<std::pair<std::uint64_t, Work>> waiting_;
    std::map<std::uint64_t, hive::Json> results_;  ///< the oldest are dropped when there are too many
    std::vector<std::thread> threads_;             ///< as many as were ever busy at once
};

}  // namespace hivectl::dash
