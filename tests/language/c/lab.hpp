// What the tests of whole swarms in C stand on: a home with real drones, and swarm files as handles.
#pragma once

#include "world.hpp"

#include <hive_swarm.h>

#include <swarm.hpp>

#include <functional>

#include <cerrno>
#include <sys/wait.h>

namespace world {

constexpr auto long_timeout = 60'000ms;  // on a machine that does much else

/// A source and workers that share what it gives.
inline Json workers_file(int workers)
{
    return {{"swarm", "work"},
            {"drones",
             {{"source", {{"kind", "ticker"}, {"set", {{"fps", 50}, {"bytes", 100}}}}},
              {"worker", {{"kind", "sleeper"}, {"count", workers}, {"set", {{"work_ms", 1}}}}}}},
            {"connections", {{{"from", "source"}, {"to", "worker-*"}, {"share", true}}}}};
}

/// An application in a home of its own, whose drones are gone at the end.
class Lab {
public:
    Lab()
    {
        const Json options{{"home", swarm.home()}, {"timeout_ms", patient(20'000ms).count()}};
        REQUIRE(hive_application_new(options.dump().c_str(), &application) == HIVE_OK);
    }
    ~Lab()
    {
        hive_on_wait(nullptr, nullptr);
        hive_release(application);
    }
    Lab(const Lab&) = delete;
    Lab& operator=(const Lab&) = delete;

    [[nodiscard]] std::vector<std::string> drones() const
    {
        REQUIRE_MESSAGE(hive_application_drones(application, text.place(), nullptr) == HIVE_OK, error());
        return text.json().get<std::vector<std::string>>();
    }
    [[nodiscard]] Json get(const char* drone, const char* name) const
    {
        REQUIRE_MESSAGE(hive_application_get(application, drone, nullptr, text.place()) == HIVE_OK, error());
        return text.json().at(name);
    }
    [[nodiscard]] std::int64_t pid(const char* drone) const
    {
        REQUIRE_MESSAGE(hive_application_status(application, drone, text.place(), nullptr) == HIVE_OK, error());
        return text.json().at("pid");
    }
    [[nodiscard]] Json remembered() const
    {
        REQUIRE(hive_swarm_remembered(application, text.place(), nullptr) == HIVE_OK);
        return text.json();
    }
    [[nodiscard]] bool is_empty() const { return drones().empty() && remembered().empty() && !has_children(); }
    /// Not one, not even a defunct one.
    static bool has_children() { return ::waitpid(-1, nullptr, WNOHANG) != -1 || errno != ECHILD; }

    hive::test::Swarm swarm;
    hive_application* application = nullptr;
    mutable Text text;
};

class File {
public:
    File(const Lab& lab, const Json& content)
    {
        REQUIRE_MESSAGE(hive_swarm_open(lab.application, content.dump().c_str(), nullptr, &handle) == HIVE_OK, error());
    }
    ~File() { hive_release(handle); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    using Progress = std::function<bool(std::size_t done, std::size_t all, const std::string& what)>;
    /// @param progress  false: cancels
    [[nodiscard]] Json up(Progress progress = {}) const
    {
        Text text;
        const auto call = [](void* user, std::size_t done, std::size_t all, const char* what) -> hive_code {
            return (*static_cast<Progress*>(user))(done, all, what) ? HIVE_OK : HIVE_FAILED;
        };
        REQUIRE_MESSAGE(hive_swarm_up(handle, patient(long_timeout).count(), progress ? +call : nullptr, &progress,
                                      text.place(), nullptr)
                            == HIVE_OK,
                        error());
        return text.json();
    }
    /// What was done; nothing may fail.
    [[nodiscard]] std::vector<std::string> done() const
    {
        const auto outcome = up();
        CHECK_MESSAGE(outcome.at("failures").empty(), outcome);
        CHECK_MESSAGE(outcome.at("remains").empty(), outcome);
        return words(outcome.at("steps"));
    }
    [[nodiscard]] std::vector<std::string> down() const
    {
        Text text;
        REQUIRE_MESSAGE(hive_swarm_down(handle, patient(long_timeout).count(), nullptr, nullptr, text.place(), nullptr)
                            == HIVE_OK,
                        error());
        CHECK_MESSAGE(text.json().at("failures").empty(), text.text());
        return words(text.json().at("steps"));
    }
    static std::vector<std::string> words(const Json& steps)
    {
        std::vector<std::string> all;
        for (const auto& step : steps)
            all.push_back(step.at("step").get<std::string>() + " " + step.at("what").get<std::string>());
        return all;
    }

    hive_swarm* handle = nullptr;
};

/// Of an outcome that must have failed, with nothing left of it: the first failure.
inline Json failure(const Json& outcome)
{
    CHECK_MESSAGE(outcome.at("remains").empty(), outcome);
    REQUIRE_MESSAGE(!outcome.at("failures").empty(), outcome);
    return outcome.at("failures").at(0);
}

/// A drone that has given back its name may take a moment to end; down reaps it then.
inline bool leaves_nothing(const Lab& lab, const File& file)
{
    return eventually([&] { return file.down().empty() && lab.is_empty(); });
}

inline hive_code cancels_when_set(void* user) { return *static_cast<bool*>(user) ? HIVE_FAILED : HIVE_OK; }

}  // namespace world
