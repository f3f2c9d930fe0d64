// Drones that take long until they are ready on another machine, or end there before they are met from here.
#include "fake_ssh.hpp"
#include "worker_swarm.hpp"

#include <doctest/doctest.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

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
    // As a terminal does, it signals the whole process group, once the drone is begun.
    words.insert(words.begin(),
                 {"/bin/bash", "-c",
                  "set -m; \"$@\" & until test -e " + log + "; do sleep 0.05; done; sleep 0.5; kill -INT -$!; wait $!",
                  "bash"});
    const auto interrupted = here.run(words, 90'000ms);
    CHECK_MESSAGE(interrupted.exit_code == 130, interrupted.err);
    CHECK_MESSAGE(has(interrupted.err, "hivectl up: interrupted: undoing what was begun."), interrupted.err);
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
    CHECK_MESSAGE(has(refused.err, "gpu2: brief was ready and has ended since; its log says:"), refused.err);
    CHECK_MESSAGE(has(refused.err, "listening on tcp://"), refused.err);
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
    CHECK(there.application().remembered().empty());
}
