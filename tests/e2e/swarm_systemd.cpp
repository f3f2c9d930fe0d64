// Whole swarms as units of the user's systemd. No systemd is needed: a fake systemd-run and systemctl run the units.
#include "falling_drone.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>
#include <mute_server.hpp>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <set>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;
namespace fs = std::filesystem;

namespace {

class Systemd {
public:
    Systemd() : directory_(swarm.home() / "systemd")
    {
        fs::create_directories(directory_ / "bin");
        for (const char* name : {"bin/systemctl", "bin/systemd-run"}) {
            fs::copy_file(fs::path(HIVE_SOURCE_DIR) / "tests/e2e/systemd_stand_in.py", file(name));
            fs::permissions(file(name), fs::perms::owner_all);
        }
    }
    ~Systemd()
    {
        std::string stop = "hivectl stop --all; systemctl --user stop";
        for (const auto& unit : units())
            stop += " " + unit;
        static_cast<void>(shell(stop));
    }
    Systemd(const Systemd&) = delete;
    Systemd& operator=(const Systemd&) = delete;

    /// Runs a shell command with the fake systemd.
    [[nodiscard]] Finished shell(const std::string& line) const
    {
        const char* const path = std::getenv("PATH");
        return swarm.run({"/usr/bin/env", "HIVE_TEST_SYSTEMD=" + directory_.string(),
                          "PATH=" + (directory_ / "bin").string() + ":"
                              + swarm.program("hivectl").parent_path().string() + ":" + (path ? path : ""),
                          "/bin/sh", "-c", line},
                         60'000ms);
    }
    std::string shell_done(const std::string& line) const
    {
        const auto done = shell(line);
        REQUIRE_MESSAGE(done.exit_code == 0, line, done.err);
        return done.out;
    }
    /// The loaded ones.
    [[nodiscard]] std::set<std::string> units() const
    {
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(directory_))
            if (entry.path().extension() == ".json")
                names.insert(entry.path().stem());
        return names;
    }
    [[nodiscard]] std::string property(const std::string& unit, const std::string& name) const
    {
        return hive::parse_json(text_of(file(unit + ".json"))).at("properties").value(name, "");
    }
    [[nodiscard]] fs::path file(const std::string& name) const { return directory_ / name; }
    std::string write(const Json& content) const
    {
        const auto path = (swarm.home() / "work.json").string();
        std::ofstream(path) << content.dump(2);
        return path;
    }

    Swarm swarm;

private:
    fs::path directory_;
};

Json work()
{
    return {{"swarm", "work"},
            {"drones",
             {{"source", {{"kind", "ticker"}, {"set", {{"fps", 50}}}}},
              {"worker", {{"kind", "sleeper"}, {"count", 2}, {"set", {{"work_ms", 1}}}, {"restart", "on-failure"}}}}},
            {"connections", {{{"from", "source"}, {"to", "worker-*"}, {"share", true}}}},
            {"engines", {{"local", {{"systemd", Json::object()}}}}}};
}

}  // namespace

TEST_CASE("up under systemd: drones are units of the user, and one that crashes comes back with its wires")
{
    const Systemd systemd;
    const auto up = "hivectl up " + systemd.write(work());
    CHECK(lines_of(systemd.shell_done(up)) == 3 + 2);
    CHECK(systemd.shell_done(up).empty());
    CHECK(systemd.units()
          == std::set<std::string>{"hive-source.service", "hive-worker-1.service", "hive-worker-2.service"});
    auto application = systemd.swarm.application();
    const auto before = application.status("worker-1").pid;
    ::kill(static_cast<pid_t>(before), SIGKILL);
    CHECK(eventually(
        [&] {
            const auto answer = application.status(std::vector<std::string>{"worker-1"}).at(0);
            const auto* now = value_of(answer.status);
            return now && now->pid != before && !now->inputs.empty() && now->inputs.at(0).received > 0;
        },
        10'000ms));
    CHECK(lines_of(systemd.shell_done("hivectl down")) == 3);
    CHECK(systemd.swarm.application().drones().empty());
    CHECK(eventually([&] { return systemd.units().empty(); }, 5000ms));
}

TEST_CASE("up under systemd: a changed restart is in a new unit")
{
    const Systemd systemd;
    auto content = work();
    systemd.shell_done("hivectl up " + systemd.write(content));
    content["drones"]["source"]["restart"] = "on-failure";
    const auto up = "hivectl up " + systemd.write(content);
    CHECK_EQ(systemd.shell_done(up), "restart source restart=on-failure\n");
    CHECK(systemd.property("hive-source.service", "Restart") == "on-failure");
    CHECK(systemd.shell_done(up).empty());
    content["drones"]["source"]["memory_mib"] = 512;
    systemd.write(content);
    CHECK_EQ(systemd.shell_done(up), "restart source memory_mib=512\n");
    CHECK(systemd.property("hive-source.service", "MemoryMax") == "512M");
    CHECK(systemd.shell_done(up).empty());
}

TEST_CASE("up under systemd: the drone of another home is left alone, and what runs is said")
{
    const Systemd systemd;
    const auto up = "hivectl up " + systemd.write(work());
    systemd.shell_done(up);
    auto application = systemd.swarm.application();
    const auto before = application.status("worker-1").pid;
    const auto elsewhere = "HIVE_HOME=" + systemd.file("elsewhere").string() + " ";
    const auto refused = systemd.shell(elsewhere + up);
    CHECK(refused.exit_code == 5);
    CHECK_MESSAGE(has(refused.err, ".service runs already, of another home"), refused.err);
    CHECK(application.status("worker-1").pid == before);
    systemd.shell_done("hivectl down");
    systemd.shell_done(elsewhere + up);
    systemd.shell_done(elsewhere + "hivectl down");
}

TEST_CASE("up under systemd: where there is no systemctl nothing is left, of other engines neither")
{
    const Systemd systemd;
    auto content = work();
    content["drones"]["far"] = {{"kind", "ticker"}, {"on", "beside"}};
    content["engines"] = {{"local", content["engines"].begin().value()}, {"beside", {{"local", Json::object()}}}};
    const auto bare = "PATH=" + systemd.swarm.program("hivectl").parent_path().string() + ":/usr/bin:/bin";
    fs::remove_all(systemd.file("bin"));
    const auto refused = systemd.shell(bare + " hivectl up " + systemd.write(content));
    CHECK_MESSAGE(refused.exit_code == 5, refused.err);
    CHECK_MESSAGE(has(refused.err, " is unchanged, because:"), refused.err);
    CHECK(systemd.swarm.application().drones().empty());
    CHECK(systemd.units().empty());
}

TEST_CASE("up under systemd: a drone of another machine is not started here")
{
    const Systemd systemd;
    auto content = work();
    content["drones"]["far"] = {{"kind", "ticker"}, {"on", "cam1"}};
    content["engines"]["cam1"] = {{"systemd", Json::object()}};
    const auto refused = systemd.shell("hivectl up " + systemd.write(content));
    CHECK(refused.exit_code == 5);
    CHECK_MESSAGE(has(refused.err, "systemd starts drones of this machine, and not of cam1"), refused.err);
    CHECK(systemd.swarm.application().drones().empty());
    CHECK(systemd.units().empty());
}

TEST_CASE("up under systemd: a unit file of an earlier version is refused with the command that removes it")
{
    const Systemd systemd;
    const auto up = "hivectl up " + systemd.write(work());
    const auto file = systemd.file("hive-source.service.file").string();
    std::ofstream(file) << "# Written by hivectl up\n";
    const auto refused = systemd.shell(up);
    CHECK(refused.exit_code == 5);
    CHECK_MESSAGE(has(refused.err, "hive-source.service has a unit file, " + file), refused.err);
    CHECK_MESSAGE(has(refused.err, "remove it: rm " + file + " && systemctl --user daemon-reload"), refused.err);
    CHECK(eventually([&] { return systemd.units().empty(); }));  // systemd lists one that has ended for a moment
    CHECK(systemd.swarm.application().drones().empty());
    fs::remove(file);
    systemd.shell_done(up);
}

TEST_CASE("up under systemd: when systemd stops answering, up ends by its timeout, and the next down stops all")
{
    const Systemd systemd;
    write_falling_drone(systemd.file("programs"));
    auto content = work();
    content["drones"]["brief"] = {{"kind", "falls"}};
    std::ofstream(systemd.file("hang")) << "";
    const auto path = "HIVE_DRONE_PATH=" + systemd.file("programs").string();
    const auto late = systemd.shell(path + " hivectl up " + systemd.write(content) + " --timeout 20");
    fs::remove(systemd.file("hang"));
    CHECK(late.exit_code == 5);
    CHECK_MESSAGE(has(late.err, "brief: systemctl --user does not answer"), late.err);
    CHECK_MESSAGE(has(late.err, "source: not undone: systemctl --user does not answer"), late.err);
    CHECK(late.took < patient(50'000ms));
    systemd.shell_done("hivectl down");
    CHECK(systemd.swarm.application().drones().empty());
}

TEST_CASE("up under systemd: what cannot run is said with the last lines of its log, and no unit is left")
{
    const Systemd systemd;
    auto content = work();
    const MuteServer other;
    const auto taken = "tcp://127.0.0.1:" + other.port();
    content["drones"]["zlast"] = {{"kind", "ticker"}, {"listen", taken}, {"insecure", true}};
    const auto refused = systemd.shell("hivectl up " + systemd.write(content));
    CHECK(refused.exit_code == 5);
    CHECK_MESSAGE(has(refused.err, "zlast ended with exit code"), refused.err);
    CHECK_MESSAGE(has(refused.err, taken), refused.err);
    CHECK(systemd.units().empty());
    CHECK(systemd.swarm.application().drones().empty());

    write_falling_drone(systemd.file("programs"));
    content = work();
    content["drones"]["brief"] = {{"kind", "falls"}};  // when it has its name, before it is ready
    const auto path = "HIVE_DRONE_PATH=" + systemd.file("programs").string();
    const auto fallen = systemd.shell(path + " hivectl up " + systemd.write(content) + " --timeout 50");
    CHECK(fallen.exit_code == 5);
    CHECK_MESSAGE(has(fallen.err, "brief ended with exit code 7"), fallen.err);
    CHECK(systemd.units().empty());

    content = work();
    content["drones"]["worker"]["restart"] = "always";
    const auto always = systemd.shell("hivectl up " + systemd.write(content));
    CHECK(always.exit_code == 5);
    CHECK_MESSAGE(has(always.err, "on-failure"), always.err);
    CHECK(systemd.units().empty());

    std::ofstream(systemd.file("broken")) << "";
    const auto silent = systemd.shell("hivectl up " + systemd.write(work()));
    CHECK(silent.exit_code == 5);
    CHECK_MESSAGE(has(silent.err, "Failed to connect to bus"), silent.err);
    fs::remove(systemd.file("broken"));
}
