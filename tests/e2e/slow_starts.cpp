// Drones on another machine that start slowly, or are unreachable from here: the reason is reported at once.
#include "fake_ssh.hpp"
#include "worker_swarm.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <utility>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// A swarm of one drone on that machine.
Json far_ticker(const std::string& ssh, const Json& drone)
{
    Json ticker{{"kind", "ticker"}, {"on", "far"}};
    ticker.update(drone);
    return {{"swarm", "far"}, {"drones", {{"t", ticker}}}, {"engines", {{"far", {{"ssh", ssh}}}}}};
}

}  // namespace

TEST_CASE("up: that a drone on another machine has another key, or is not reached from here, is said at once")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    here.hivectl_done({"key", "new"});
    there.hivectl_done({"key", "new"});
    const File file(here, far_ticker("me@gpu1", {{"key", there.key_file().string()}}));
    const auto other_key = ssh.hivectl({"up", file, "--timeout", "100"});
    CHECK(other_key.exit_code == 5);
    CHECK(other_key.took < patient(5'000ms));
    CHECK_MESSAGE(has(other_key.err, "t: cannot reach tcp://127.0.0.1:"), other_key.err);
    CHECK_MESSAGE(has(other_key.err, "wrong swarm key"), other_key.err);
    file.write(far_ticker("me@gpu3", {{"insecure", true}}));
    const auto closed = ssh.hivectl({"up", file, "--timeout", "100"});
    CHECK(closed.exit_code == 5);
    CHECK(closed.took < patient(8'000ms));
    CHECK_MESSAGE(
        has(closed.err, "t runs on gpu3 and is not reached from here: t: cannot reach tcp://nowhere.invalid:"),
        closed.err);
    CHECK_MESSAGE(has_processes(there, 0), closed.err);
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
}

TEST_CASE(
    "down: drones of another machine that are gone, or hang, are ended by the next one if ssh gets there only then")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    auto content = far_ticker("me@gpu1", {{"insecure", true}});
    content["drones"]["hung"] = content["drones"]["gone"] = content["drones"]["t"];
    const File file(here, content);
    REQUIRE(ssh.hivectl({"up", file}).exit_code == 0);
    for (const auto& [drone, signal] : {std::pair{"gone", SIGKILL}, {"hung", SIGSTOP}})
        ::kill(static_cast<pid_t>(there.application().status(drone).pid), signal);
    const auto without_ssh = here.hivectl({"down", "--timeout", "1"});
    CHECK(without_ssh.exit_code != 0);
    CHECK(without_ssh.out == "t\n");
    const auto down = ssh.hivectl({"down", "--timeout", "3"});
    CHECK_MESSAGE(down.exit_code == 0, down.err);
    CHECK(lines_of(down.out) == 2);
    CHECK(has_processes(there, 0));
    CHECK(there.application().remembered().empty());
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
    CHECK(has(ssh.hivectl({"down"}).err, "no swarm was brought up"));
}

TEST_CASE("up: --timeout holds, and the drones of other machines are ended, though a machine does not answer")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    auto content = far_ticker("me@gpu4", {{"insecure", true}});
    content["drones"]["beside"] = {{"kind", "sleeper"}, {"on", "gpu1"}, {"insecure", true}};
    content["drones"]["near"] = {{"kind", "sleeper"}};
    content["engines"]["gpu1"] = {{"ssh", "me@gpu1"}};
    const File file(here, content);
    const auto refused = ssh.hivectl({"up", file, "--timeout", "4"});
    CHECK(refused.exit_code == 5);
    CHECK(refused.took < patient(6'500ms));
    CHECK_MESSAGE(has(refused.err, "gpu4 has not answered in time: whether t runs there is unknown"), refused.err);
    CHECK_MESSAGE(has_processes(there, 0), refused.err);
    CHECK_MESSAGE(has_processes(here, 0), refused.err);
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
}

TEST_CASE("up: Ctrl-C leaves nothing behind on another machine, however long a drone there takes until it is ready")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const File file(
        here, {{"swarm", "far"},
               {"drones",
                {{"late", {{"kind", "sleeper"}, {"on", "gpu1"}, {"insecure", true}, {"set", {{"start_ms", 40'000}}}}}}},
               {"engines", {{"gpu1", {{"ssh", "me@gpu1"}}}}}});
    auto words = ssh.words({"up", file});
    const auto log = (there.home() / "late.log").string();
    // Like a terminal, it signals the whole process group once the drone is starting.
    words.insert(words.begin(),
                 {"/bin/bash", "-c",
                  "set -m; \"$@\" & until test -e " + log + "; do sleep 0.05; done; sleep 0.5; kill -INT -$!; wait $!",
                  "bash"});
    const auto interrupted = here.run(words, 90'000ms);
    CHECK_MESSAGE(interrupted.exit_code == 130, interrupted.err);
    CHECK_MESSAGE(has(interrupted.err, "hivectl up: interrupted: rolling back."), interrupted.err);
    CHECK(has_processes(there, 0));
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
}

TEST_CASE("up: a drone on another machine that ends before it is met from here is told at once, with its last words")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const File file(here, {{"swarm", "far"},
                           {"drones", {{"brief", {{"kind", "sleeper"}, {"on", "gpu2"}, {"insecure", true}}}}},
                           {"engines", {{"gpu2", {{"ssh", "me@gpu2"}}}}}});
    const auto refused = ssh.hivectl({"up", file, "--timeout", "120"});
    CHECK(refused.exit_code == 5);
    CHECK(refused.took < patient(15'000ms));
    CHECK_MESSAGE(has(refused.err, "gpu2: brief was ready and has exited since; its log says:"), refused.err);
    CHECK_MESSAGE(has(refused.err, "listening on tcp://"), refused.err);
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
    CHECK(there.application().remembered().empty());
}
