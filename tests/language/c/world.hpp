// What the tests of the ABI stand on: a home of their own, drones that run in threads, and texts that free themselves.
#pragma once

#include <hive.h>

#include <eventually.hpp>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>

namespace world {

using Json = nlohmann::json;
using hive::test::eventually;
using hive::test::patient;
using namespace std::chrono_literals;

/// Drones and applications of this process meet in a fresh directory.
class Home {
public:
    Home()
    {
        std::string name = "/tmp/hv-XXXXXX";
        REQUIRE(::mkdtemp(name.data()));
        path = name;
        ::setenv("HIVE_HOME", name.c_str(), 1);
    }
    ~Home()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    Home(const Home&) = delete;
    Home& operator=(const Home&) = delete;
    std::filesystem::path path;
};

/// A char* that the library gave.
class Text {
public:
    ~Text() { hive_free(text_); }
    Text() = default;
    Text(const Text&) = delete;
    Text& operator=(const Text&) = delete;
    char** place()
    {
        hive_free(std::exchange(text_, nullptr));
        return &text_;
    }
    [[nodiscard]] bool empty() const { return !text_; }
    [[nodiscard]] std::string text() const { return text_; }
    [[nodiscard]] Json json() const { return Json::parse(text_); }

private:
    char* text_ = nullptr;
};

inline std::string error() { return hive_error_text(); }

/// Runs until the test ends; the drone is stopped and released then.
class Running {
public:
    explicit Running(hive_drone* drone) : drone_(drone), thread_([this] { result = hive_drone_run(drone_); }) {}
    ~Running() { end(); }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;
    /// Stops it and waits.
    void end()
    {
        if (!thread_.joinable())
            return;
        eventually([&] { return ended() || hive_drone_stop(drone_) == HIVE_OK; });
        thread_.join();
        hive_release(drone_);
    }
    std::atomic<hive_code> result = -1;

private:
    [[nodiscard]] bool ended() const { return result != -1; }
    hive_drone* drone_;
    std::thread thread_;
};

inline hive_drone* new_drone(const char* kind, const Json& options = Json::object())
{
    hive_drone* drone = nullptr;
    REQUIRE(hive_drone_new(kind, "For tests.", options.dump().c_str(), &drone) == HIVE_OK);
    return drone;
}

inline hive_application* new_application()
{
    hive_application* application = nullptr;
    const Json options{{"timeout_ms", patient(5000ms).count()}};
    REQUIRE(hive_application_new(options.dump().c_str(), &application) == HIVE_OK);
    return application;
}

inline void await(hive_application* application, const char* drone)
{
    REQUIRE_MESSAGE(hive_application_wait(application, drone, "running", patient(5000ms).count()) == HIVE_OK, error());
}

}  // namespace world
