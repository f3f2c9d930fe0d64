// hivectl explain: drones that crash, hang or are silent, each caused for real and named.
#include "explained.hpp"

#include <free_port.hpp>
#include <possible.hpp>
#include <raw_peer.hpp>

#include <doctest/doctest.h>

#include <csignal>
#include <fcntl.h>
#include <thread>
#include <unistd.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

TEST_CASE("explain: a drone that has crashed, with its signal and where (needs a build without sanitizers)")
{
    if (!injectable(missing_if_sanitized()))
        return;
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=20"}), fragile = swarm.drone("crasher", "fragile");
    auto application = swarm.application();
    application.set("fragile", {{"from", 40}});  // 2 s later
    swarm.hivectl_done({"connect", "source", "fragile"});
    const auto crashed = awaited(swarm, "explain fragile", "crashed fragile");
    CHECK_MESSAGE(has(crashed.text(), "SIGSEGV in crasher::write_to_null"), crashed.text());
    CHECK(crashed.command() == "hivectl start crasher --as fragile");
    CHECK(found(swarm, "explain").causes == "crashed fragile");
    const auto evidence = [&] { return found(swarm, "explain fragile").evidence(); };
    CHECK_MESSAGE(eventually([&] { return has(evidence(), "its input is kept: hivectl rerun fragile 1"); }),
                  evidence());
    CHECK(has(swarm.hivectl_done({"ps"}), "; hivectl rerun fragile 1"));
    CHECK(has(swarm.hivectl({"rerun", "fragile", "1"}, 30'000ms).out, "SIGSEGV in crasher::write_to_null"));
    cure(swarm, crashed);
    CHECK(runs(swarm, "explain source fragile"));
}

TEST_CASE("explain: a drone that its swarm starts again and again")
{
    const Swarm swarm;
    const auto file = (swarm.home() / "falls.json").string();
    std::ofstream(file) << R"({"swarm": "fall", "drones": {"falls": {"kind": "ticker", "restart": "on-failure"}}})";
    const auto up = swarm.hivectl_running({"up", file, "--stay"}, "up");
    REQUIRE(eventually([&] { return has(swarm.log("up"), "falls"); }));
    auto application = swarm.application();
    std::int64_t last = 0;
    for (int fall = 0; fall < 6; ++fall) {
        REQUIRE_MESSAGE(eventually([&] {
                            const auto answer = application.status(std::vector<std::string>{"falls"}).at(0);
                            const auto* now = value_of(answer.status);
                            const bool again = now && now->pid != last && now->state != hive::State::starting;
                            last = again ? now->pid : last;
                            return again;
                        }),
                        swarm.log("up"));
        ::kill(static_cast<pid_t>(last), SIGKILL);
    }
    const auto failed = awaited(swarm, "explain", "failed falls");
    CHECK_MESSAGE(has(failed.text(), "crashed 6 times in a row"), failed.text());
    cure(swarm, failed);
    CHECK(eventually([&] { return found(swarm, "explain falls").causes != "failed falls"; }, 20'000ms));
}

TEST_CASE("explain: a drone of this machine that does not answer, and one of another that is gone")
{
    const Swarm near, far;
    raw::Listener listener(near.home() / "mute.sock");
    const int lock = ::open((near.home() / "mute.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    struct flock whole {};
    whole.l_type = F_WRLCK;
    REQUIRE(::fcntl(lock, F_OFD_SETLK, &whole) == 0);
    std::jthread mute([&](const std::stop_token& over) {
        std::vector<raw::Peer> peers;
        while (!over.stop_requested())
            if (auto peer = listener.accept(50ms)) {
                peer->send(raw::hello_packet("mute", "camera"));
                peers.push_back(std::move(*peer));
            }
    });
    const auto silent = awaited(near, "explain mute --timeout 0.5", "no_answer mute");
    mute.request_stop();
    mute.join();
    ::close(lock);
    CHECK(silent.command() == "hivectl logs mute");

    auto source =
        far.drone("ticker", "source", {}, {"--listen", "tcp://127.0.0.1:" + std::to_string(free_port()), "--insecure"});
    const auto places = far.application().status("source").places;
    const auto port =
        std::ranges::find_if(places, [](const std::string& place) { return place.starts_with("tcp://"); });
    REQUIRE(port != places.end());
    near.hivectl_done({"place", "add", "source", *port});
    const auto worker = near.drone("sleeper", "worker");
    near.hivectl_done({"connect", "source", "worker"});
    CHECK(runs(near, "explain worker"));
    source.kill();
    const auto gone = awaited(near, "explain worker", "unreachable source");
    CHECK_MESSAGE(has(gone.text(), "source at 127.0.0.1 does not answer"), gone.text());
    CHECK(gone.command() == "hivectl place list");
}

TEST_CASE("explain: drones on two machines that have one name")
{
    const Swarm near, far;
    const auto here = near.drone("ticker", "source"), worker = near.drone("sleeper", "worker");
    near.hivectl_done({"connect", "source", "worker"});
    CHECK(runs(near, "explain"));
    const auto there =
        far.drone("ticker", "source", {}, {"--listen", "tcp://127.0.0.1:" + std::to_string(free_port()), "--insecure"});
    const auto sink = far.drone("sleeper", "sink");
    far.hivectl_done({"connect", "source", "sink"});
    const auto places = far.application().status("source").places;
    const auto port = std::ranges::find_if(places, [](const auto& place) { return place.starts_with("tcp://"); });
    REQUIRE(port != places.end());
    near.hivectl_done({"place", "add", "source", *port});
    const auto same = awaited(near, "explain", "same_name source");
    CHECK_MESSAGE(has(same.text(), "2 drones are called source"), same.text());
    CHECK(same.evidence() == "the oldest first: source@local, source@127.0.0.1");
    CHECK(same.exit_code == 0);  // events still pass
    CHECK(near.hivectl({"get", "source"}).exit_code != 0);
    cure(near, same);
    CHECK(near.hivectl({"get", "source"}).exit_code == 0);
    CHECK(runs(near, "explain"));
}

TEST_CASE("explain: a sender that refuses a connection, and why")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=20"}),
               worker = swarm.drone("sleeper", "worker", {}, {"--connect", "image=source.tock"});
    const auto refused = awaited(swarm, "explain worker", "refused worker");
    CHECK_MESSAGE(has(refused.text(), "tock"), refused.text());
    CHECK_MESSAGE(has(refused.command(), "hivectl disconnect source.tock worker.image"), refused.text());
    cure(swarm, refused);
    cure(swarm, awaited(swarm, "explain worker", "not_connected worker"));
    CHECK(runs(swarm, "explain worker"));
}

TEST_CASE("explain: a set that is prepared and not decided")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=20"}), worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "source", "worker"});
    CHECK(runs(swarm, "explain worker"));
    auto asker = raw::Peer::meet(swarm.home() / "worker.sock", "undecided");
    REQUIRE(
        raw::error_of(asker.ask(raw::set, {{"parameters", {{"work_ms", 1}}}, {"prepare", 7}, {"deadline_ms", 20'000}}))
        == "");
    std::jthread alive([&](const std::stop_token& over) {
        while (!over.stop_requested())
            asker.next(50ms);
    });
    const auto prepared = awaited(swarm, "explain worker", "set_prepared worker");
    cure(swarm, prepared);
    CHECK(runs(swarm, "explain worker"));
    alive.request_stop();
    alive.join();
}

TEST_CASE("explain: on demand, a source that is only watched")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    CHECK(awaited(swarm, "explain source", "no_receiver source").command() == "hivectl results source");
    const auto watcher = swarm.hivectl_running({"results", "source", "--notify"}, "watcher");
    const auto watched = awaited(swarm, "explain source", "watched source");
    CHECK(watched.command() == "hivectl results source");
    CHECK(lines_of(swarm.hivectl_done({"results", "source", "-n", "5"})) == 5);
}

TEST_CASE("explain: code that has been busy with one event for far longer than usual, and one that emits nothing")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"}), worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    const auto results = swarm.hivectl_running({"results", "worker", "--stay"}, "results");
    application.connect({"source", ""}, {"worker", ""});
    CHECK(runs(swarm, "explain worker"));
    application.set("worker", {{"hang_from", application.status("source").outputs.at(0).produced + 25}});
    const auto stuck = awaited(swarm, "explain worker", "stuck worker", 30'000ms);
    CHECK_MESSAGE(has(stuck.evidence(), "input image"), stuck.text());
    CHECK(stuck.command() == "hivectl replace worker");
    cure(swarm, stuck);
    CHECK(runs(swarm, "explain worker"));

    CHECK(eventually([&] { return processed(application, "worker") > 300; }));  // often enough to be usual
    application.set("worker", {{"emits", false}});
    const auto mute = awaited(swarm, "explain worker", "emits_nothing worker");
    CHECK(mute.exit_code == 0);
    CHECK_MESSAGE(has(mute.text(), "processes events and sends nothing at result"), mute.text());
}

TEST_CASE("explain: a source that makes nothing and does not say why")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50", "count=20", "ends=false"});
    const auto worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "source", "worker"});
    const auto silent = awaited(swarm, "explain worker", "silent_source source");
    CHECK(silent.command() == "hivectl replace source");
    CHECK(found(swarm, "explain").causes == "silent_source source");
    auto application = swarm.application();
    const auto before = processed(application, "worker");
    cure(swarm, silent);
    CHECK(eventually([&] { return processed(application, "worker") >= before + 15; }));
}

TEST_CASE("explain: a camera that encodes all the time")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"source=scene", "width=1920", "height=1080", "fps=60"}),
               worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "camera", "worker", "--encoding", "png"});
    const auto slow = awaited(swarm, "explain worker", "encoder worker");
    CHECK(slow.exit_code == 0);
    CHECK_MESSAGE(has(slow.text(), "camera encodes all the time, as png"), slow.text());
    CHECK(slow.command() == "hivectl connect camera.image worker.image --encoding raw");
    cure(swarm, slow);
    CHECK(runs(swarm, "explain worker"));
}

TEST_CASE("explain: bodies that shared memory does not take")
{
    const Swarm swarm;
    const auto done = swarm.run({"/bin/bash", "-c",
                                 "ulimit -f 256; exec " + swarm.program("hivectl").string()
                                     + " start ticker --as source fps=20 bytes=1000000"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "source", "worker"});
    const auto copied = awaited(swarm, "explain worker", "copied worker");
    CHECK(copied.exit_code == 0);
    CHECK_MESSAGE(has(copied.evidence(), " copied, 0 through shared memory"), copied.text());
    cure(swarm, copied);  // by a process without the limit
    CHECK(runs(swarm, "explain worker"));
}

TEST_CASE("explain: a camera that goes away while it is read, and comes back")
{
    const Swarm swarm;
    const auto port = std::to_string(free_port()), token = std::string(32, 't');
    const auto url = "http://127.0.0.1:" + port + "/stream.mjpg?token=" + token;
    const auto scene = swarm.drone("camera", "scene", {"fps=20", "width=160", "height=120"});
    std::optional<Process> server;
    const auto serve = [&] {
        server = swarm.drone("view", "view", {"http=" + port, "token=" + token}, {}, {"DISPLAY="});
    };
    serve();
    swarm.hivectl_done({"connect", "scene", "view"});
    const auto camera = swarm.drone("camera", "camera", {"source=" + url}), worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "camera", "worker"});
    REQUIRE(runs(swarm, "explain worker"));
    server->kill();
    const auto gone = awaited(swarm, "explain worker", "condition camera");
    CHECK(gone.exit_code == 9);
    CHECK_MESSAGE(has(gone.evidence(), "source=http://127.0.0.1:" + port + "/stream.mjpg"), gone.text());
    CHECK(gone.command() == "hivectl set camera source=SOURCE");
    CHECK(swarm.hivectl({"set", "camera", "source=scene"}).exit_code == 0);  // another camera
    CHECK(runs(swarm, "explain worker"));
    swarm.hivectl_done({"set", "camera", "source=" + url});
    awaited(swarm, "explain worker", "condition camera");
    serve();  // it is plugged in again
    CHECK(runs(swarm, "explain worker"));
}

TEST_CASE("explain: work that is shared with the key of a viewer, who may only watch")
{
    const Swarm near, far;
    far.hivectl_done({"key", "new"});
    far.hivectl_done({"key", "view"});
    const auto members = far.key_file(), viewers = members.parent_path() / "viewer.key", here = near.key_file();
    const auto use = [&](const std::filesystem::path& key) {
        std::filesystem::create_directories(here.parent_path());
        std::filesystem::copy_file(key, here, std::filesystem::copy_options::overwrite_existing);
        std::filesystem::permissions(here, std::filesystem::perms(0600));
    };
    use(members);
    const auto at = "tcp://127.0.0.1:" + std::to_string(free_port());
    const auto source = far.drone("ticker", "source", {"fps=20"}, {"--listen", at});
    near.hivectl_done({"place", "add", "source", at});
    auto worker = near.drone("sleeper", "worker");
    near.hivectl_done({"connect", "source", "worker", "--group", "workers"});
    CHECK(runs(near, "explain worker"));
    use(viewers);
    worker.kill();
    worker.wait(5000ms);
    worker = near.drone("sleeper", "worker");
    const auto refused = awaited(near, "explain worker", "refused worker");
    CHECK_MESSAGE(has(refused.text(), "a viewer may not share work"), refused.text());
    CHECK(refused.command() == "hivectl key show");
    const auto set = near.hivectl({"set", "source", "fps=10"});
    CHECK_MESSAGE(has(set.err, "a viewer may not send set; use the members' key: hivectl key show"), set.err);
    CHECK(found(near, "explain source worker").command() == "hivectl key show");
    near.hivectl_done({"set", "worker", "emits=false"});
    near.hivectl_done({"connect", "source", "worker"});
    far.hivectl_done({"set", "source", "pace=demand"});
    const auto passive = awaited(near, "explain worker", "watched source");
    CHECK_MESSAGE(has(passive.text(), "only viewers receive source.tick"), passive.text());
    CHECK(passive.command() == "hivectl key show");
    use(members);  // which that command prints on the machine of a member
    CHECK(runs(near, "explain worker"));
    CHECK(near.hivectl({"set", "source", "fps=10"}).exit_code == 0);
}
