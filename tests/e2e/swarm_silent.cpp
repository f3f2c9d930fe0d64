// A drone that hangs does not block `up` of the others: it is left as it is, and named; what is undone is undone beside
// it.
#include "programs_for_tests.hpp"
#include "worker_swarm.hpp"

#include <doctest/doctest.h>
#include <hive/event/home.hpp>

#include <csignal>

using namespace hive::test;
using namespace std::chrono_literals;

TEST_CASE("up: a drone that does not answer does not block the others, is left as it is, and named")
{
    const Swarm swarm;
    auto content = workers_file(2);
    const File file(swarm, content);
    steps(swarm, file);
    const auto pid = static_cast<pid_t>(hive::event::Home(swarm.home()).holder("worker-1"));
    ::kill(pid, SIGSTOP);
    content["drones"]["worker"]["count"] = 3;
    content["drones"]["worker"]["set"]["work_ms"] = 2;
    file.write(content);
    for (const auto& words : {std::vector<std::string>{"up", file, "--dry-run"}, {"up", file}}) {
        const auto result = swarm.hivectl(words);
        const bool dry_run = words.size() == 3;
        CHECK(result.exit_code == (dry_run ? 0 : 8));
        CHECK(has(result.err, "worker-1 does not answer, so it and its connections are unchanged"));
        CHECK(has(result.out, "start worker-3"));
        CHECK(has(result.out, "set worker-2 work_ms=2"));
        CHECK_FALSE(has(result.out, "worker-1"));
    }
    CHECK(swarm.hivectl_done({"get", "worker-3", "work_ms"}) == "2\n");
    ::kill(pid, SIGCONT);
    CHECK(steps(swarm, file) == std::vector<std::string>{"set worker-1 work_ms=2"});
    CHECK(edges(swarm) == 6);
}

TEST_CASE("up: what it did beside a drone that does not answer is what comes back after a crash")
{
    const Swarm swarm;
    auto content = workers_file(2);
    content["drones"]["worker"]["restart"] = "on-failure";
    const File file(swarm, content);
    auto up = swarm.hivectl_running({"up", file, "--stay"}, "stay");
    REQUIRE(eventually([&] { return edges(swarm) == 4; }, 20'000ms));
    const hive::event::Home home(swarm.home());
    ::kill(static_cast<pid_t>(home.holder("sink")), SIGSTOP);
    content["drones"]["worker"]["set"]["work_ms"] = 7;
    content["connections"].erase(0);
    file.write(content);
    CHECK(swarm.hivectl({"up", file}).exit_code == 8);
    const auto before = home.holder("worker-1");
    ::kill(static_cast<pid_t>(before), SIGKILL);
    REQUIRE(eventually([&] { return swarm.hivectl({"get", "worker-1", "work_ms"}).out == "7\n"; }, 20'000ms));
    CHECK(home.holder("worker-1") != before);
    ::kill(static_cast<pid_t>(home.holder("sink")), SIGCONT);
    CHECK(eventually([&] { return edges(swarm) == 2; }, 20'000ms));
    up.signal(SIGINT);
    CHECK(up.wait(10'000ms) == 0);
}

TEST_CASE("up: the code of a drone that hangs does not block the others")
{
    const Swarm swarm;
    auto content = workers_file(2);
    const File file(swarm, content);
    steps(swarm, file);
    swarm.hivectl_done({"set", "worker-1", "hang_from=1"});
    REQUIRE(eventually([&] { return has(swarm.hivectl({"ps", "worker-1"}).out, "busy"); }, 20'000ms));
    content["drones"]["worker"]["set"]["work_ms"] = 7;
    file.write(content);
    const auto result = swarm.hivectl({"up", file});
    CHECK(result.exit_code == 8);
    CHECK(result.out == "set worker-2 work_ms=7\n");
    CHECK_MESSAGE(has(result.err, "worker-1 was busy"), result.err);
}

/// Drones that run and are connected, of which worker-1 has been suspended, and a file that changes and adds.
class Suspended {
public:
    explicit Suspended(const std::string& kind_of_last) : file_(swarm_, workers_file(2))
    {
        steps(swarm_, file_);
        auto content = workers_file(3);
        content["drones"]["worker"]["set"]["work_ms"] = 2;
        content["drones"]["last"]["kind"] = kind_of_last;
        pid_ = static_cast<pid_t>(hive::event::Home(swarm_.home()).holder("worker-1"));
        ::kill(pid_, SIGSTOP);
        file_.write(content);
    }
    ~Suspended() { ::kill(pid_, SIGCONT); }

    [[nodiscard]] const Swarm& swarm() const { return swarm_; }
    [[nodiscard]] const File& file() const { return file_; }
    /// As before, and the one that was suspended goes on.
    void check_unchanged() const
    {
        ::kill(pid_, SIGCONT);
        CHECK(has_processes(swarm_, 4));
        CHECK(swarm_.hivectl_done({"get", "worker-*", "work_ms"}) == "worker-1 work_ms=1\nworker-2 work_ms=1\n");
        CHECK(eventually([&] { return edges(swarm_) == 4; }));
        file_.write(workers_file(2));
        CHECK(steps(swarm_, file_).empty());
    }

private:
    const Swarm swarm_;
    const File file_;
    pid_t pid_ = 0;
};

TEST_CASE("up: when a drone does not start beside one that does not answer, the others are as before")
{
    const Programs programs({"hive-broken"}, R"(#!/bin/sh
case "$*" in *--describe*) echo '{"kind": "broken", "inputs": [], "outputs": [], "parameters": []}'; exit ;; esac
exit 1
)");
    const Suspended world("broken");
    const auto refused = world.swarm().hivectl({"up", world.file()}, 60'000ms);
    CHECK_MESSAGE(refused.exit_code != 0, refused.out);
    CHECK(refused.exit_code != 8);
    CHECK_MESSAGE(has(refused.err, "last"), refused.err);
    world.check_unchanged();
}

TEST_CASE("up: Ctrl-C beside a drone that does not answer undoes what was begun")
{
    const Programs programs({"hive-slow"}, R"(#!/bin/sh
case "$*" in *--describe*) echo '{"kind": "slow", "inputs": [], "outputs": [], "parameters": []}'; exit ;; esac
exec sleep 60
)");
    const Suspended world("slow");
    auto up = world.swarm().hivectl_running({"up", world.file()}, "up");
    REQUIRE(eventually([&] { return std::filesystem::exists(world.swarm().home() / "worker-3.sock"); }, 20'000ms));
    up.signal(SIGINT);
    CHECK(up.wait(patient(20'000ms)) == 130);
    world.check_unchanged();
}
