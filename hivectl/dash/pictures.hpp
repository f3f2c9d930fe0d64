// Receives the outputs that pages show: each once, however many pages show it, and only as long as one does.
#pragma once

#include "jpeg.hpp"

#include <hive/http/answer.hpp>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace hivectl::dash {

class Pictures {
public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr std::size_t max_outputs = 64;

    struct Newest {
        std::uint64_t version = 0;  ///< 0: there is none yet
        std::string type{};
        hive::http::Bytes bytes{};
        std::string problem{};  ///< why none comes
    };

    /// @param ready  called from its threads when there is a new picture, or a problem
    Pictures(std::filesystem::path home, std::function<void()> ready);
    ~Pictures();
    Pictures(const Pictures&) = delete;
    Pictures& operator=(const Pictures&) = delete;

    /// The newest of an output for a box of that width. Whoever shows it calls this again and again; when nobody has
    /// for some seconds, the output is no longer received. Never waits.
    /// @param after  what the page has: one that is newer is received next
    Newest newest(const std::string& output, int width, std::uint64_t after, Time now);

private:
    class Source;
    const std::filesystem::path home_;
    const std::function<void()> ready_;
    std::map<std::string, std::unique_ptr<Source>> sources_;  ///< for the thread that asks
};

}  // namespace hivectl::dash
