// Receives the outputs that pages show: each once for all pages, and only while one shows it.
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

class Images {
public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr std::size_t max_outputs = 64;

    struct Newest {
        std::uint64_t version = 0;  ///< 0: there is none yet
        std::string type{};
        hive::http::Bytes bytes{};
        std::string problem{};  ///< why there is none
    };

    /// @param ready  called on its threads for a new image or a problem
    Images(std::filesystem::path home, std::function<void()> ready);
    ~Images();
    Images(const Images&) = delete;
    Images& operator=(const Images&) = delete;

    /// The newest image of an output for a box of this width. Pages call it repeatedly; some seconds after the last
    /// call the output is no longer received. Never blocks.
    /// @param after  the version that the page has: a newer one is received next
    Newest newest(const std::string& output, int width, std::uint64_t after, Time now);

private:
    class Source;
    const std::filesystem::path home_;
    const std::function<void()> ready_;
    std::map<std::string, std::unique_ptr<Source>> sources_;  ///< for the calling thread
};

}  // namespace hivectl::dash
