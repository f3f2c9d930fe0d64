// Drones that are started on another machine through ssh: replaced, read and forgotten there, and what is missing there
// is said.
#include "rows.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <cstdlib>
#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// A program called ssh that finds one machine: the other home. It keeps to the few words that hivectl says to ssh.
class FakeSsh {
public:
    FakeSsh(const Swarm& here, const Swarm& there)
        : here_(here), directory_(here.home() / "ssh"), path_(directory_.string() + ":" + std::getenv("PATH"))
    {
        std::filesystem::create_directory(directory_);
        const auto file = directory_ / "ssh";
        std::ofstream(file) << "#!/bin/sh\n"
                               "if [ \"$1\" = -G ]; then echo hostname 127.0.0.1; exit; fi\n"
                               "while [ \"$1\" != -- ]; do shift; done\n"
                               "case $2 in\n"
                               "  me@gpu1) HIVE_HOME="
                            << there.home().string() << " PATH=" << there.program("hivectl").parent_path().string()
                            << ":$PATH exec sh -c \"$3\" ;;\n"
                            << "  bare) PATH=/nowhere exec /bin/sh -c \"$3\" ;;\n"
                               "esac\n"
                               "echo 'ssh: Could not resolve hostname '$2 >&2\n"
                               "exit 255\n";
        std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    }
    [[nodiscard]] Finished hivectl(const std::vector<std::string>& words) const
    {
        std::vector<std::string> all{"/usr/bin/env", "PATH=" + path_, here_.program("hivectl").string()};
        all.insert(all.end(), words.begin(), words.end());
        return here_.run(all, 40'000ms);
    }

private:
    const Swarm& here_;
    std::filesystem::path directory_;
    std::string path_;
};

}  // namespace

TEST_CASE("start --on: the drone runs there, is in the list of places until it is stopped, and its log is read")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const auto started = ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "fps=7", "--insecure"});
    REQUIRE_MESSAGE(started.exit_code == 0, started.err);
    CHECK(started.out == "t-1\n");
    CHECK(there.application().get("t-1", {"fps"}) == Json{{"fps", 7.0}});
    CHECK(row_named(here.hivectl_done({"ps", "--json"}), "name", "t-1").at("host") == "gpu1");
    const auto places = Json::parse(here.hivectl_done({"place", "list", "--json"}));
    REQUIRE(places.size() == 1);
    CHECK(places.at(0).at("ssh") == "me@gpu1");
    CHECK(has(ssh.hivectl({"logs", "t-1"}).out, "listening at tcp://"));
    const auto wired = ssh.hivectl({"start", "sleeper", "--on", "me@gpu1", "--as", "worker", "--connect",
                                    "image=t-1.tick,window=2", "--insecure"});
    REQUIRE_MESSAGE(wired.exit_code == 0, wired.err);
    CHECK(there.application().status("worker").inputs.at(0).from == "t-1.tick");
    CHECK(ssh.hivectl({"stop", "worker"}).out == "worker\n");
    const auto again = ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "--insecure"});
    CHECK(again.exit_code != 0);
    CHECK(has(again.err, "gpu1"));
    CHECK(ssh.hivectl({"stop", "t-1"}).out == "t-1\n");
    CHECK(there.application().drones().empty());
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
}

TEST_CASE("replace: a drone that was started with --on is replaced there")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    REQUIRE(ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "fps=7", "--insecure"}).exit_code == 0);
    const auto before = there.application().status("t-1");
    const auto replaced = ssh.hivectl({"replace", "t-1", "bytes=9"});
    REQUIRE_MESSAGE(replaced.exit_code == 0, replaced.err);
    CHECK(replaced.out == "t-1\n");
    CHECK(there.application().get("t-1", {"fps", "bytes"}) == Json{{"fps", 7.0}, {"bytes", 9}});
    const auto after = here.application().status("t-1");
    CHECK(after.pid != before.pid);
    CHECK(after.places == before.places);
    const auto refused = ssh.hivectl({"replace", "t-1", "fps=-1"});
    CHECK(refused.exit_code == 5);
    CHECK(has(refused.err, "gpu1: "));
    CHECK(ssh.hivectl({"stop", "t-1"}).exit_code == 0);
}

TEST_CASE("start --on: a drone that crashed there is forgotten there by stop, and its last words can be read")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    REQUIRE(ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--insecure"}).exit_code == 0);
    ::kill(static_cast<pid_t>(there.application().status("ticker").pid), SIGKILL);
    REQUIRE(eventually([&] { return there.application().drones().empty(); }));
    CHECK(row_named(here.hivectl_done({"ps", "--json"}), "name", "ticker").at("state") == "unreachable");
    CHECK(has(ssh.hivectl({"logs", "ticker"}).out, "started"));
    CHECK(there.application().remembered() == std::vector<std::string>{"ticker"});
    const auto stopped = ssh.hivectl({"stop", "ticker"});
    CHECK_MESSAGE(stopped.exit_code == 0, stopped.err);
    CHECK(there.application().remembered().empty());
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
}

TEST_CASE("start --on: what is missing there is said in one sentence, with what helps")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const auto unknown_host = ssh.hivectl({"start", "ticker", "--on", "nobody", "--insecure"});
    CHECK(unknown_host.exit_code == 4);
    CHECK(has(unknown_host.err, "Could not resolve hostname nobody"));
    CHECK(has(unknown_host.err, "ssh nobody true"));
    const auto no_hivectl = ssh.hivectl({"start", "ticker", "--on", "bare", "--insecure"});
    CHECK(no_hivectl.exit_code == 3);
    CHECK(has(no_hivectl.err, "no hivectl on bare"));
    const auto no_drone = ssh.hivectl({"start", "nothing-like-it", "--on", "me@gpu1", "--insecure"});
    CHECK(no_drone.exit_code == 3);
    CHECK(has(no_drone.err, "gpu1: there is no drone hive-nothing-like-it"));
    const auto no_key = ssh.hivectl({"start", "ticker", "--on", "me@gpu1"});
    CHECK(no_key.exit_code != 0);
    CHECK(has(no_key.err, "gpu1: "));
    const auto bad_value = ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--insecure", "fps=none at all'"});
    CHECK(bad_value.exit_code != 0);
    CHECK(has(bad_value.err, "fps"));
    CHECK(ssh.hivectl({"start", "ticker", "--on", "-oProxyCommand=touch x"}).exit_code == 2);
    CHECK(there.application().drones().empty());
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
}

TEST_CASE("start --on: what concerns its machine is set through ssh, and by the swarm's key alone it is not")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    here.hivectl_done({"key", "new"});
    const auto started = ssh.hivectl({"start", "camera", "--on", "me@gpu1", "--json"});
    REQUIRE_MESSAGE(started.exit_code == 0, started.err);
    const auto set = ssh.hivectl({"set", "camera", "source=scene", "fps=7"});
    CHECK_MESSAGE(set.exit_code == 0, set.err);
    CHECK(set.out == "fps=7.0\nsource=scene\n");
    CHECK(there.application().get("camera", {"fps"}) == Json{{"fps", 7.0}});
    const auto bad = ssh.hivectl({"set", "camera", "source=/nowhere/it's not there"});
    CHECK(bad.exit_code != 0);
    CHECK(has(bad.err, "gpu1: "));

    const auto address = Json::parse(started.out).at("address").get<std::string>();
    here.hivectl_done({"place", "remove", "camera"});
    here.hivectl_done({"place", "add", "camera", address});
    const auto by_key = ssh.hivectl({"set", "camera", "source=scene"});
    CHECK(by_key.exit_code == 5);
    CHECK(has(by_key.err, "--remote-operator"));
    CHECK(ssh.hivectl({"set", "camera", "fps=8"}).exit_code == 0);
    there.hivectl_done({"stop", "camera"});
}
