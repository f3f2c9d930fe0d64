// hivectl explain: drones of another version, stopped on purpose, out of reach, or in a group, each caused for real,
// named and cured.
#include "explained.hpp"

#include <free_port.hpp>
#include <possible.hpp>

#include <doctest/doctest.h>

#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;

TEST_CASE("explain: a drone whose process is of another version of Hive")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"});
    auto worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "source", "worker"});
    CHECK(runs(swarm, "explain worker"));
    worker.kill();
    worker.wait(5000ms);
    const Process old({"/usr/bin/python3", "-c", R"(
import fcntl, os, socket, struct, sys
home = sys.argv[1]
lock = os.open(home + "/worker.lock", os.O_RDWR | os.O_CREAT, 0o600)
fcntl.fcntl(lock, 37, struct.pack("hhqqi4x", fcntl.F_WRLCK, 0, 0, 0, 0))  # F_OFD_SETLK
os.ftruncate(lock, 0)
os.pwrite(lock, str(os.getpid()).encode(), 0)
if os.path.exists(home + "/worker.sock"):
    os.unlink(home + "/worker.sock")
server = socket.socket(socket.AF_UNIX)
server.bind(home + "/worker.sock")
server.listen(50)
print("listening", flush=True)
peers = []
while True:
    peers.append(server.accept()[0])
    hello = b'{"name":"worker","kind":"sleeper","epoch":1,"pid":' + str(os.getpid()).encode() + b'}'
    peers[-1].sendall(struct.pack("<4sBBHII", b"HIVE", 2, 1, 0, len(hello), 0) + hello)
)",
                       swarm.home().string()},
                      {}, swarm.home() / "old.log");
    REQUIRE(eventually([&] { return has(swarm.log("old"), "listening"); }));  // before, it is not running
    const auto other = awaited(swarm, "explain worker --timeout 1", "refused worker");
    CHECK_MESSAGE(has(other.text(), "worker is of another version of Hive"), other.text());
    CHECK(other.command() == "hivectl replace worker --force");
    cure(swarm, other);
    CHECK(runs(swarm, "explain source worker"));
}

TEST_CASE("explain: a sender that was stopped on purpose")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "origin", {"fps=50"}), worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "origin", "worker"});
    CHECK(runs(swarm, "explain worker"));
    swarm.hivectl_done({"stop", "origin"});
    const auto stopped = awaited(swarm, "explain worker", "not_running origin");
    CHECK(stopped.command() == "hivectl start ticker --as origin");
    cure(swarm, stopped);
    CHECK(runs(swarm, "explain worker"));
}

TEST_CASE("explain: a member of a group that is dead, while another one has its work")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    auto dead = swarm.drone("sleeper", "dead", {"work_ms=4000"});
    const auto slow = swarm.drone("sleeper", "slow", {"work_ms=4000"});
    for (const auto* member : {"dead", "slow"})
        swarm.hivectl_done({"connect", "source", member, "--group", "workers"});
    const auto reader = swarm.hivectl_running({"results", "dead", "slow", "--stay"}, "reader");
    auto application = swarm.application();
    REQUIRE(eventually([&] { return application.status("dead").state == hive::State::busy; }));
    dead.kill();
    dead.wait(5000ms);
    std::filesystem::remove(swarm.home() / "dead.state");  // its kind is not known
    const auto now = awaited(swarm, "explain slow", "slow slow");
    CHECK(now.exit_code == 0);  // not that the source waits for the dead one
    CHECK(eventually([&] { return has(found(swarm, "explain slow").text(), "for one event, 99 % within 4"); }));
}

TEST_CASE("explain: a sender that listens at another port since it was started again")
{
    const Swarm near, far;
    const auto listening = [] { return "tcp://127.0.0.1:" + std::to_string(free_port()); };
    const auto worker_at = listening();
    const auto worker = far.drone("sleeper", "worker", {}, {"--listen", worker_at, "--insecure"});
    near.hivectl_done({"place", "add", "worker", worker_at});
    {
        auto source = near.drone("ticker", "source", {"fps=50"}, {"--listen", listening(), "--insecure"});
        near.hivectl_done({"connect", "source", "worker"});
        CHECK(runs(near, "explain source worker"));
        source.kill();
        source.wait(5000ms);
    }
    const auto source = near.drone("ticker", "source", {"fps=50"}, {"--listen", listening(), "--insecure"});
    const auto dialing = awaited(near, "explain worker", "dialing worker");
    CHECK_MESSAGE(has(dialing.text(), "worker.image is not connected to source.tick"), dialing.text());
    CHECK(dialing.command() == "hivectl connect source.tick worker.image");
    cure(near, dialing);
    CHECK(runs(near, "explain source worker"));
}

TEST_CASE("explain: a machine that is out of reach, and since when")
{
    const Swarm near, far;
    const auto at = "tcp://127.0.0.1:" + std::to_string(free_port());
    auto source = far.drone("ticker", "source", {"fps=50"}, {"--listen", at, "--insecure"});
    near.hivectl_done({"place", "add", "source", at});
    const auto worker = near.drone("sleeper", "worker");
    near.hivectl_done({"connect", "source", "worker"});
    CHECK(runs(near, "explain worker"));
    source.kill();
    source.wait(5000ms);
    const auto gone = awaited(near, "explain worker", "unreachable source");
    CHECK_MESSAGE(has(gone.evidence(), "worker.image lost it "), gone.text());
    CHECK_MESSAGE(has(gone.evidence(), " ago"), gone.text());
}

TEST_CASE("explain: code that throws at each event, and whose author has corrected it")
{
    if (!injectable(sanitized() ? "a build without sanitizers, which Python cannot load" : ""))
        return;
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"});
    const auto file = (swarm.home() / "broken.py").string();
    const auto write = [&](const std::string& body) {
        std::ofstream(file) << "import hive\n"
                               "drone = hive.Drone('broken', 'Throws.')\n"
                               "result = drone.output('result', 'application/json', 'results')\n"
                               "@drone.on_event('in', '*/*', 'anything')\n"
                               "def work(event):\n    "
                                   + body + "\ndrone.run()\n";
    };
    write("raise ValueError('division by cucumber')");
    REQUIRE(swarm.hivectl({"start", file, "--as", "broken"}).exit_code == 0);
    swarm.hivectl_done({"connect", "source", "broken"});
    const auto thrown = awaited(swarm, "explain broken", "throws broken");
    CHECK_MESSAGE(has(thrown.text(), "division by cucumber"), thrown.text());
    write("result.emit({'fine': True})");
    cure(swarm, thrown);
    CHECK(runs(swarm, "explain source broken"));
}
