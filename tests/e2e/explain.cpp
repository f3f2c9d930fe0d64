// hivectl explain: each fault is caused for real, named with its evidence, and fixed by the proposed command.
#include "explained.hpp"

#include <hive/printable.hpp>

#include <doctest/doctest.h>
#include <free_port.hpp>

#include <csignal>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

TEST_CASE("explain: a pipeline that runs is said to run, with rates")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"}), worker = swarm.drone("sleeper", "worker");
    CHECK(found(swarm, "explain source").causes.empty() == false);  // it has no receivers
    CHECK(found(swarm, "explain source").exit_code == 0);
    swarm.hivectl_done({"connect", "source", "worker"});
    Found now;
    REQUIRE_MESSAGE(eventually([&] { return (now = found(swarm, "explain worker")).runs(); }), now.text());
    REQUIRE(now.json.at("flows").size() == 2);
    const auto &first = now.json.at("flows").at(0), &second = now.json.at("flows").at(1);
    CHECK(first.at("drone") == "source");
    CHECK(first.at("emitted_per_s").get<double>() > 10);
    CHECK(second.at("received_per_s").get<double>() > 10);
    const auto table = swarm.hivectl_done({"explain", "worker"});
    CHECK_MESSAGE(table.starts_with("nothing holds up worker\n"), table);
    CHECK(has(table, "source"));
}

TEST_CASE("explain: halted, suspended or killed, and of two faults the one nearest to the source is named first")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"});
    auto worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""});
    const auto runs = [&] { return found(swarm, "explain worker").runs(); };
    REQUIRE(eventually(runs));

    application.halt("worker");
    application.halt("source");
    const auto both = awaited(swarm, "explain worker", "halted source, halted worker");
    CHECK(both.command() == "hivectl resume source");
    CHECK(found(swarm, "explain").causes == both.causes);
    CHECK(found(swarm, "explain source worker").causes == both.causes);
    cure(swarm, both);
    const auto one = found(swarm, "explain worker");
    CHECK(one.causes == "halted worker");
    CHECK_MESSAGE(has(one.evidence(), " ago, as app"), one.text());
    cure(swarm, one);
    CHECK(eventually(runs));

    source.signal(SIGSTOP);
    const auto suspended = awaited(swarm, "explain worker --timeout 0.5", "suspended source");
    cure(swarm, suspended);
    CHECK(eventually(runs));

    worker.kill();
    const auto killed = awaited(swarm, "explain worker", "not_running worker");
    CHECK(killed.command() == "hivectl start sleeper --as worker");
    CHECK(found(swarm, "explain").causes == "not_running worker");
    cure(swarm, killed);  // it restores its connection
    CHECK(eventually(runs));
    CHECK(found(swarm, "explain nobody").causes == "not_running nobody");
}

TEST_CASE("explain: a sender that is gone is the cause, not the receiver that dials it")
{
    const Swarm swarm;
    auto source = swarm.drone("ticker", "source", {"fps=50"});
    const auto worker = swarm.drone("sleeper", "worker"), last = swarm.drone("sleeper", "last");
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""});
    application.connect({"worker", ""}, {"last", ""});
    const auto runs = [&] { return found(swarm, "explain last").runs(); };
    REQUIRE(eventually(runs));
    source.kill();
    const auto gone = awaited(swarm, "explain last", "not_running source");
    cure(swarm, gone);
    CHECK(eventually(runs));
}

TEST_CASE("explain: what is not connected, the wrong way round, or of types that do not fit")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"}), worker = swarm.drone("sleeper", "worker"),
               counter = swarm.drone("counter", "counter"), other = swarm.drone("counter", "other");
    const auto pair = awaited(swarm, "explain source worker", "not_connected worker");
    CHECK(pair.command() == "hivectl connect source worker");
    awaited(swarm, "explain other counter", "wrong_types counter");
    const auto back = found(swarm, "explain worker counter");  // it accepts no results, but gives the worker a receiver
    CHECK_MESSAGE(back.command() == "hivectl connect counter worker", back.text());
    const auto turned = awaited(swarm, "explain worker source", "wrong_way source");
    CHECK(turned.command() == pair.command());
    const auto alone = awaited(swarm, "explain counter", "not_connected counter");
    CHECK(alone.command() == "hivectl connect source counter");
    cure(swarm, alone);
    cure(swarm, turned);
    CHECK(eventually([&] { return found(swarm, "explain source worker").runs(); }));
    CHECK(eventually([&] { return found(swarm, "explain counter").runs(); }));
    CHECK(found(swarm, "explain worker source").causes == "wrong_way source");
}

TEST_CASE("explain: code that throws at each event, a drone that is starting, and a source that has ended")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"});
    auto application = swarm.application();
    const auto worker = swarm.drone("sleeper", "worker", {"throw_every=1"});
    application.connect({"source", ""}, {"worker", ""});
    const auto thrown = awaited(swarm, "explain worker", "throws worker");
    CHECK(has(thrown.text(), "is one of those"));
    CHECK_MESSAGE(has(thrown.evidence(), "its input is kept: hivectl rerun worker "), thrown.evidence());
    CHECK(has(thrown.evidence(), "see hivectl exceptions worker"));
    CHECK(has(swarm.hivectl_done({"exceptions", "worker"}), "is one of those"));
    CHECK(thrown.command() == "hivectl replace worker");  // with the program that no longer throws: see below
    application.set("worker", {{"throw_every", 0}});
    CHECK(eventually([&] { return found(swarm, "explain worker").runs(); }));

    const Process late({swarm.program("hive-sleeper").string(), "--name", "late", "--set", "start_ms=2500"},
                       {"HIVE_HOME=" + swarm.home().string()}, swarm.home() / "late.log");
    const auto starting = awaited(swarm, "explain late", "starting late");
    cure(swarm, starting);
    const auto ready = awaited(swarm, "explain late", "not_connected late");

    const auto clip = swarm.drone("ticker", "clip", {"pace=demand", "count=5"});
    application.connect({"clip", ""}, {"late", ""});
    const auto held = awaited(swarm, "explain late", "held late");
    CHECK(held.command() == "hivectl results late");
    CHECK(lines_of(swarm.hivectl_done({"results", "late", "-n", "1"})) == 1);
    const auto results = application.collect({{"late", "result"}});
    const auto ended = awaited(swarm, "explain late", "source_ended clip");
    cure(swarm, ended);
    CHECK(eventually([&] { return processed(application, "late") == 10; }));
}

TEST_CASE("explain: code that throws now and then is not said to throw at each event")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=2.5"}),  // it processes each event
        worker = swarm.drone("sleeper", "worker", {"work_ms=350", "throw_every=4"});
    swarm.hivectl_done({"connect", "source", "worker"});
    auto application = swarm.application();
    REQUIRE(eventually([&] { return processed(application, "worker") > 3; }));
    for (int i = 0; i < 10; ++i) {
        const auto now = found(swarm, "explain worker");
        CHECK_MESSAGE(!has(now.causes, "throws"), now.text());
    }
}

TEST_CASE("explain: a camera whose server requires a login")
{
    const Swarm swarm;
    const auto port = std::to_string(free_port());
    const Process server({"/usr/bin/python3", "-c", R"(
import socketserver, sys
class Refusing(socketserver.StreamRequestHandler):
    def handle(self):
        request = []
        for line in self.rfile:
            request.append(line)
            if line == b"\r\n":
                number = [line for line in request if line.lower().startswith(b"cseq")]
                self.wfile.write(b"RTSP/1.0 401 Unauthorized\r\n" + b"".join(number)
                                 + b'WWW-Authenticate: Basic realm="x"\r\n\r\n')
                request = []
socketserver.ThreadingTCPServer(("127.0.0.1", int(sys.argv[1])), Refusing).serve_forever()
)",
                          port},
                         {}, swarm.home() / "server.log");
    const auto camera = swarm.drone("camera", "camera", {"source=rtsp://127.0.0.1:" + port + "/x"});
    auto application = swarm.application();
    const auto collector = application.collect({{"camera", "image"}});
    Found refused;
    CHECK_MESSAGE(eventually([&] {
                      refused = found(swarm, "explain camera");
                      return refused.causes == "condition camera" && has(refused.text(), "login required");
                  }),
                  refused.text());
    count("condition camera", refused);
    CHECK(refused.command() == "hivectl set camera credentials=FILE");
}

TEST_CASE("explain: a camera without its source, and one whose file has ended")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=http://127.0.0.1:9/none.mjpg"});
    auto application = swarm.application();
    const auto collector = application.collect({{"camera", "image"}});
    const auto away = awaited(swarm, "explain camera", "condition camera");
    CHECK(has(away.text(), "source=http://127.0.0.1:9/none.mjpg"));
    CHECK(away.command() == "hivectl set camera source=SOURCE");
    const auto snap = swarm.hivectl({"snap", "camera", "x.jpg", "--timeout", "1"});
    CHECK_MESSAGE(has(snap.err, away.command()), snap.err);
    swarm.hivectl_done({"set", "camera", "source=scene"});
    CHECK(eventually([&] { return found(swarm, "explain camera").runs(); }));

    swarm.hivectl_done({"snap", "camera", (swarm.home() / "it's one.png").string()});
    application.set("camera",
                    {{"source", (swarm.home() / "it's one.png").string()}, {"loop", false}, {"pace", "demand"}});
    const auto ended = awaited(swarm, "explain camera", "source_ended camera");
    while (collector->next(100ms)) {
    }
    cure(swarm, ended);
    CHECK(eventually([&] { return collector->next(100ms).has_value(); }));  // another process has set it
}

TEST_CASE("explain: on demand a source waits for a receiver that is gone, that is slow, or that never asks")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"}), stays = swarm.drone("sleeper", "stays");
    auto gone = swarm.drone("sleeper", "gone");
    auto application = swarm.application();
    application.connect({"source", ""}, {"stays", ""});
    application.connect({"source", ""}, {"gone", ""});
    const auto reader = swarm.hivectl_running({"results", "stays", "gone"}, "reader");
    const auto runs = [&] { return found(swarm, "explain stays").runs(); };
    REQUIRE(eventually(runs));
    gone.kill();
    const auto away = awaited(swarm, "explain stays", "not_running gone");
    CHECK(has(away.evidence(), "source.tick"));
    const auto silent = swarm.hivectl({"results", "stays", "--timeout", "0.2"});
    CHECK_MESSAGE(has(silent.err, "gone is not running"), silent.err);
    CHECK_MESSAGE(has(silent.err, away.command()), silent.err);
    CHECK(found(swarm, "explain").causes == "not_running gone");
    std::filesystem::remove(swarm.home() / "gone.state");  // its kind is not known
    const auto unknown = awaited(swarm, "explain stays", "receiver_away gone");
    cure(swarm, unknown);
    CHECK(eventually(runs));

    const auto slow = swarm.drone("sleeper", "slow", {"work_ms=4000"});
    const auto other_reader = swarm.hivectl_running({"results", "slow"}, "other_reader");
    application.connect({"source", ""}, {"slow", ""});
    const auto slowly = awaited(swarm, "explain stays", "slow slow");
    CHECK(slowly.exit_code == 0);
    application.disconnect({"source", ""}, {"slow", ""});
    awaited(swarm, "explain stays", "slow slow");  // it leaves after its last event
    REQUIRE(eventually(runs));

    const auto collector =
        application.collect({{"source", "tick"}}, {.connection = {.window = 1, .group = {}, .lease = {}}});
    const auto idle = awaited(swarm, "explain stays", "waits source");
    CHECK(has(idle.text(), application.name()));
    cure(swarm, idle);
    CHECK(eventually(runs));
}

TEST_CASE("explain: of all drones, a source on demand is not blamed for the receiver that it waits for")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"}), worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""});
    const auto held = awaited(swarm, "explain", "held worker");
    const auto source_is_quiet = [&] {  // for long enough to be called silent
        const auto status = application.status("source");
        return status.epoch + status.uptime_us - status.outputs.at(0).last_emitted_us > 4'000'000;
    };
    REQUIRE(eventually(source_is_quiet));
    for (const std::string words : {"explain", "explain source worker", "explain worker", "explain source"})
        CHECK(found(swarm, words).causes == "held worker");
    application.halt("source");
    const auto both = found(swarm, "explain");
    CHECK_MESSAGE(both.causes == "halted source, held worker", both.text());
}

TEST_CASE("explain: a group that has lost its members, and one whose member is suspended")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    auto worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    const auto reader = swarm.hivectl_running({"results", "worker", "--stay"}, "reader");
    application.connect({"source", ""}, {"worker", ""}, {.group = "workers", .lease = {}});
    const auto runs = [&] { return found(swarm, "explain source worker").runs(); };
    REQUIRE(eventually(runs));
    worker.signal(SIGSTOP);
    const auto suspended = awaited(swarm, "explain source worker --timeout 0.5", "suspended worker");
    cure(swarm, suspended);
    CHECK(eventually(runs));
    worker.kill();
    const auto lost = awaited(swarm, "explain source", "not_running worker");
    cure(swarm, lost);
    CHECK(eventually(runs));
}
