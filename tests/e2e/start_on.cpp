// Drones started on another machine over ssh: replaced, their logs read, and forgotten there; and errors for what is
// missing there.
#include "fake_ssh.hpp"
#include "rows.hpp"
#include "successors.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <thread>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

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
    CHECK(has(ssh.hivectl({"logs", "t-1"}).out, "listening on tcp://"));
    const auto wired = ssh.hivectl({"start", "sleeper", "--on", "me@gpu1", "--as", "worker", "--connect",
                                    "image=t-1.tick,window=2", "--insecure"});
    REQUIRE_MESSAGE(wired.exit_code == 0, wired.err);
    CHECK(there.application().status("worker").inputs.at(0).from == "t-1.tick");
    CHECK(ssh.hivectl({"stop", "worker"}).out == "worker\n");
    const auto again = ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "--insecure"});
    CHECK(again.exit_code != 0);
    CHECK(has(again.err, "t-1 is running already, at tcp://127.0.0.1:"));
    CHECK(ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "--if-missing"}).out == "t-1\n");
    here.hivectl_done({"place", "remove", "t-1"});
    const auto unknown_here = ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "--insecure"});
    CHECK(unknown_here.exit_code != 0);
    CHECK(has(unknown_here.err, "t-1 is running already on gpu1"));
    CHECK(ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "--if-missing"}).out == "t-1\n");
    CHECK(ssh.hivectl({"stop", "t-1"}).out == "t-1\n");
    CHECK(there.application().drones().empty());
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
}

TEST_CASE("start: Ctrl-C at any moment leaves no drone behind, here and on another machine")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const std::string press = "set -m; \"$@\" & sleep $0; kill -INT -$!; wait $!";
    int interrupted = 0;
    for (int i = 0; i < 40; ++i) {
        const auto name = "t-" + std::to_string(i);
        const auto pause = "0.0" + std::string(i < 20 ? "0" : "") + std::to_string(i % 20 / 2 + 1);
        const auto done = here.run(
            {"/bin/bash", "-c", press, pause, here.program("hivectl").string(), "start", "ticker", "--as", name});
        interrupted += done.exit_code == 130 ? 1 : 0;
        CAPTURE(pause);
        CHECK((done.exit_code == 130 || done.exit_code == 0));
        CHECK((done.exit_code == 0) == (here.hivectl({"get", name, "fps"}).exit_code == 0));
    }
    MESSAGE(interrupted, " of 40 starts were interrupted");
    here.hivectl({"stop", "--all"});
    for (const std::string pause : {"0.005", "0.02", "0.05", "0.1"}) {
        CAPTURE(pause);
        auto words = ssh.words({"start", "ticker", "--on", "me@gpu1", "--as", "far", "--insecure"});
        words.insert(words.begin(), {"/bin/bash", "-c", press, pause});
        const auto done = here.run(words, 60'000ms);
        CHECK((done.exit_code == 130 || done.exit_code == 0));
        std::this_thread::sleep_for(300ms);  // a drone that was starting there would be up by now
        const bool runs = !there.application().drones().empty();
        CHECK_MESSAGE(runs == (done.exit_code == 0), done.err);
        CHECK(here.application().drones().empty() != runs);
        if (runs)
            CHECK(ssh.hivectl({"stop", "far"}).exit_code == 0);
    }
}

TEST_CASE("start --if-missing: of two at once one starts the drone, and both are content")
{
    const Swarm swarm;
    std::vector<std::int64_t> pids;
    for (int round = 0; round < 20; ++round) {
        const auto name = "t-" + std::to_string(round);
        const std::vector<std::string> words{"start", "ticker", "--as", name, "--if-missing", "--json"};
        auto one = swarm.hivectl_running(words, "one-" + name), two = swarm.hivectl_running(words, "two-" + name);
        CHECK_MESSAGE(one.wait(patient(20'000ms)) == 0, swarm.log("one-" + name));
        CHECK_MESSAGE(two.wait(patient(20'000ms)) == 0, swarm.log("two-" + name));
        const auto pid = swarm.application().status(name).pid;
        for (const auto& text : {swarm.log("one-" + name), swarm.log("two-" + name)})
            CHECK_MESSAGE(Json::parse(text).at("pid") == pid, text);
        swarm.hivectl_done({"stop", name});
    }
}

TEST_CASE("replace: a drone that was started with --on is replaced there")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    REQUIRE(ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "fps=7", "--insecure"}).exit_code == 0);
    const auto before = there.application().status("t-1");
    const auto replaced = ssh.hivectl({"replace", "t-1", "bytes=9", "--json"});
    REQUIRE_MESSAGE(replaced.exit_code == 0, replaced.err);
    const auto row = Json::parse(replaced.out);
    CHECK(row.at("before") == before.pid);
    CHECK(row.at("host") == "gpu1");
    CHECK(there.application().get("t-1", {"fps", "bytes"}) == Json{{"fps", 7.0}, {"bytes", 9}});
    const auto after = here.application().status("t-1");
    CHECK(after.pid != before.pid);
    CHECK(after.places == before.places);
    const auto refused = ssh.hivectl({"replace", "t-1", "fps=-1"});
    CHECK(refused.exit_code == 5);
    CHECK(has(refused.err, "gpu1: "));
    CHECK(ssh.hivectl({"stop", "t-1"}).exit_code == 0);
}

TEST_CASE(
    "replace: with --force a drone of another machine that hangs is killed there, and is found again at its address")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    REQUIRE(ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "fps=7", "--insecure"}).exit_code == 0);
    REQUIRE(ssh.hivectl({"start", "sleeper", "--on", "me@gpu1", "--as", "worker", "--connect", "image=t-1.tick",
                         "--insecure"})
                .exit_code
            == 0);
    const auto before = here.application().status("t-1");
    ::kill(static_cast<pid_t>(before.pid), SIGSTOP);
    const auto refused = ssh.hivectl({"replace", "t-1"});
    CHECK(refused.exit_code != 0);
    CHECK_MESSAGE(has(refused.err, "hivectl replace t-1 --force"), refused.err);
    CHECK(processes_of(there, "t-1") == std::vector{static_cast<pid_t>(before.pid)});
    const auto replaced = ssh.hivectl({"replace", "t-1", "--force", "bytes=9", "--json"});
    REQUIRE_MESSAGE(replaced.exit_code == 0, replaced.err);
    const auto row = Json::parse(replaced.out);
    CHECK(row.at("before") == before.pid);
    CHECK(row.at("host") == "gpu1");
    CHECK(there.application().get("t-1", {"fps", "bytes"}) == Json{{"fps", 7.0}, {"bytes", 9}});
    const auto after = here.application().status("t-1");
    CHECK(after.pid == row.at("pid"));
    CHECK(processes_of(there, "t-1") == std::vector{static_cast<pid_t>(after.pid)});
    CHECK(after.places == before.places);
    CHECK(Json::parse(here.hivectl_done({"place", "list", "--json"})).size() == 2);
    CHECK(eventually([&] { return there.application().status("worker").inputs.at(0).connected; }));
    for (const char* drone : {"worker", "t-1"})
        CHECK(ssh.hivectl({"stop", drone}).exit_code == 0);
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
    const auto as_json = ssh.hivectl({"start", "nothing-like-it", "--on", "me@gpu1", "--insecure", "--json"});
    const auto error = Json::parse(as_json.err).at("error");
    CHECK(error.at("code") == "not_found");
    CHECK(has(error.at("text"), "gpu1: there is no drone hive-nothing-like-it"));
    CHECK(has(error.at("advice"), "hivectl start --help"));
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

TEST_CASE("start --on: a swarm key that is missing there, or another one, is said with the line that copies it")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const auto file = here.home() / "config" / "hive" / "swarm.key";
    const auto copy = "scp " + file.string() + " me@gpu5:.config/hive/swarm.key";
    const auto start = [&] { return ssh.hivectl({"start", "ticker", "--on", "me@gpu5"}); };
    CHECK(!has(start().err, copy));  // no key here
    here.hivectl_done({"key", "new"});
    const auto missing = start();
    CHECK(missing.exit_code == 5);
    CHECK_MESSAGE(has(missing.err, "gpu5 has no swarm key; copy the one of this machine: ssh me@gpu5 mkdir -p"),
                  missing.err);
    CHECK(has(missing.err, copy));
    there.hivectl_done({"key", "new"});
    const auto other = start();
    CHECK(other.exit_code == 5);
    CHECK_MESSAGE(has(other.err, "gpu5 has another swarm key; copy the one of this machine"), other.err);
    CHECK(there.application().drones().empty());
    std::filesystem::copy_file(file, there.home() / "config" / "hive" / "swarm.key",
                               std::filesystem::copy_options::overwrite_existing);
    const auto same = start();
    CHECK_MESSAGE(same.exit_code == 0, same.err);
    CHECK(ssh.hivectl({"stop", "ticker"}).exit_code == 0);
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
    const auto as_json = ssh.hivectl({"set", "camera", "source=/nowhere/it's not there", "--json"});
    CHECK(has(Json::parse(as_json.err).at("error").at("text"), "gpu1: "));

    const auto address = Json::parse(started.out).at("address").get<std::string>();
    here.hivectl_done({"place", "remove", "camera"});
    here.hivectl_done({"place", "add", "camera", address});
    const auto by_key = ssh.hivectl({"set", "camera", "source=scene"});
    CHECK(by_key.exit_code == 5);
    CHECK(has(by_key.err, "--remote-operator"));
    CHECK(ssh.hivectl({"set", "camera", "fps=8"}).exit_code == 0);
    there.hivectl_done({"stop", "camera"});
}
