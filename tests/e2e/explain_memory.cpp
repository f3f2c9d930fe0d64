// Drones whose control group has little memory left: a real group of this kernel, and the files of a container.
#include "explained.hpp"

#include <possible.hpp>

#include <csignal>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

namespace fs = std::filesystem;

/// A group below that of this process, with a limit. Not valid if this kernel or user cannot make one.
class Group {
public:
    explicit Group(std::int64_t limit)
    {
        std::ifstream file("/proc/self/cgroup");
        for (std::string line; std::getline(file, line);) {
            const bool second_version = line.starts_with("0::");
            if (second_version && !path_.empty())
                continue;
            if (!second_version && line.find(":memory:") == std::string::npos)
                continue;
            const fs::path mount(second_version ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory");
            path_ = mount / fs::path(line.substr(line.rfind(':') + 1)).relative_path()
                    / ("hive-test-" + std::to_string(::getpid()));
            limit_ = path_ / (second_version ? "memory.max" : "memory.limit_in_bytes");
        }
        made_ = !path_.empty() && ::mkdir(path_.c_str(), 0700) == 0;
        std::ofstream(limit_) << limit << std::flush;
        std::int64_t set = 0;
        std::ifstream(limit_) >> set;
        valid_ = set > limit / 2 && set <= limit;
    }
    ~Group()
    {
        if (made_)
            CHECK(eventually([&] { return ::rmdir(path_.c_str()) == 0; }));  // once its processes have exited
    }
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;
    [[nodiscard]] bool valid() const { return valid_; }
    [[nodiscard]] std::string processes() const { return (path_ / "cgroup.procs").string(); }

private:
    fs::path path_{}, limit_{};
    bool made_ = false, valid_ = false;
};

}  // namespace

TEST_CASE("explain: the control group of a drone has little memory left, and the command frees it")
{
    constexpr std::int64_t limit = 256 << 20;
    const Group group(limit);
    if (!injectable(group.valid() ? "" : "the right to make a control group with a memory limit"))
        return;
    const Swarm swarm;
    const auto start = [&](const std::string& words) {
        return swarm.run(
            {"/bin/sh", "-c",
             "echo $$ > " + group.processes() + "; exec " + swarm.program("hivectl").string() + " start " + words});
    };
    const auto source = swarm.drone("ticker", "source", {"fps=20"});
    REQUIRE(start("sleeper --as worker").exit_code == 0);
    REQUIRE(start("sleeper --as hog").exit_code == 0);
    for (const auto* receiver : {"worker", "hog"})
        swarm.hivectl_done({"connect", "source", receiver});
    auto application = swarm.application();
    const auto machine = application.status("worker").machine;
    CHECK(machine.memory_limited);
    CHECK(machine.memory == limit);
    CHECK(machine.memory_available > limit / 2);
    CHECK(machine.memory_available < limit);
    CHECK(!application.status("source").machine.memory_limited);
    CHECK(application.status("source").machine.memory > limit);
    REQUIRE(eventually([&] { return processed(application, "worker") > 0; }));
    CHECK(found(swarm, "explain hog").causes.empty());

    constexpr std::int64_t left = 6'000'000;  // 2 %
    application.set("hog", {{"holds_mb", (machine.memory_available - left) / 1'000'000}});
    const auto now = found(swarm, "explain hog");
    INFO(now.text());
    count("memory hog", now);
    REQUIRE(now.causes == "memory hog");
    CHECK(has(now.text(), "the control group of hog on this machine has 0.0 GB of its 0.3 GB of memory left"));
    const auto cause = now.json.at("causes").back();  // the load of the machine may be another
    CHECK(cause.at("evidence") == "hog uses 0.3 GB");
    CHECK(now.exit_code == 0);  // it blocks nothing yet
    const auto cured = swarm.run({"/bin/sh", "-c", cause.at("command").get<std::string>()});
    CHECK_MESSAGE(cured.exit_code == 0, cured.err);
    CHECK(eventually([&] { return found(swarm, "explain worker").causes.empty(); }));
    swarm.hivectl_done({"stop", "--all"});
}

TEST_CASE("status: in a container the memory is that of its control group, without cached files")
{
    if (!injectable(::geteuid() == 0 ? "" : "root, to make mounts"))
        return;
    const Swarm swarm;
    // As in a container of version 2: its own group is the root of the mount.
    const auto done =
        swarm.run({"/usr/bin/unshare", "-m", "/bin/sh", "-c",
                   "mount -t tmpfs none /sys/fs/cgroup && cd /sys/fs/cgroup && echo 500000000 > memory.max"
                   " && echo 480000000 > memory.current"
                   " && printf 'anon 1\\ninactive_file 80000000\\n' > memory.stat && exec "
                       + swarm.program("hivectl").string() + " start sleeper --as worker"});
    if (!injectable(done.exit_code != 0 && has(done.err, "unshare") ? "the right to make mounts: " + done.err : ""))
        return;
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto machine = swarm.application().status("worker").machine;
    CHECK(machine.memory_limited);
    CHECK(machine.memory == 500'000'000);
    CHECK(machine.memory_available == 100'000'000);
}
