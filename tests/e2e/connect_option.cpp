// --connect: drones connect by their own command lines, in any order of starts and kills.
#include "free_port.hpp"
#include "measure.hpp"
#include "status_sums.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

using Words = std::vector<std::string>;

/// Starts a drone as an engine does: by its command line alone.
struct Member {
    std::string kind, name;
    Words settings, words;
};

const std::vector<Member> chain{{"ticker", "source", {"fps=100"}, {}},
                                {"sleeper", "worker", {"work_ms=1"}, {"--connect", "image=source.tick,window=2"}},
                                {"sleeper", "last", {"work_ms=1"}, {"--connect", "worker.result"}}};

Process start(const Swarm& swarm, const Member& member)
{
    return swarm.drone(member.kind, member.name, member.settings, member.words);
}

std::int64_t received(hive::Application& application, const std::string& drone)
{
    return at_inputs(application.status(drone), &hive::InputStatus::received);
}

/// Does this drone receive further events?
bool receives(hive::Application& application, const std::string& drone)
{
    const auto before = received(application, drone);
    return eventually([&] { return received(application, drone) > before + 1; }, 10'000ms);
}

std::string note_of(const Swarm& swarm, const std::string& drone)
{
    for (const auto& row : Json::parse(swarm.hivectl_done({"ps", "--json"})))
        if (row.at("name") == drone)
            return row.at("note");
    return {};
}

/// Starts a program that refuses its command line.
Finished refused(const Swarm& swarm, const std::string& kind, const std::string& connection)
{
    return swarm.run({swarm.program("hive-" + kind).string(), "--name", "refused", "--connect", connection});
}

}  // namespace

TEST_CASE("--connect: drones that are started in any order, and each killed once, are the same swarm without hivectl")
{
    for (const auto& order : {std::array{0U, 1U, 2U}, std::array{2U, 1U, 0U}, std::array{1U, 2U, 0U}}) {
        const Swarm swarm;
        auto application = swarm.application();
        std::map<std::string, Process> processes;
        for (const auto index : order)
            processes.emplace(chain[index].name, start(swarm, chain[index]));
        REQUIRE(receives(application, "last"));
        for (const auto index : order) {
            processes.at(chain[index].name).kill();
            processes.erase(chain[index].name);
            processes.emplace(chain[index].name, start(swarm, chain[index]));
            CHECK_MESSAGE(receives(application, "last"), chain[index].name, " was killed");
        }
        CHECK(application.status("worker").inputs.at(0).options.window == 2);
        CHECK(application.status("worker").inputs.size() == 1);
    }
}

TEST_CASE("--connect: a camera and a face drone find faces, wired by their command lines alone")
{
    const Swarm swarm;
    const auto face = swarm.drone("face", "face", {}, {"--log-level", "debug", "--connect", "image=camera.image"});
    CHECK(has(note_of(swarm, "face"), "image from camera.image: the sender is not connected"));
    const auto waiting = Json::parse(swarm.hivectl_done({"connections", "--json", "--timeout", "10"}));
    REQUIRE(waiting.size() == 1);
    CHECK(waiting[0].at("state") == "waiting");
    CHECK(waiting[0].at("from") == "camera.image");
    CHECK(waiting[0].at("to") == "face.image");
    const auto camera = swarm.drone("camera", "camera");
    auto application = swarm.application();
    CHECK(eventually([&] { return at_inputs(application.status("face"), &hive::InputStatus::processed) >= 2; }));
    CHECK(note_of(swarm, "face").find("not connected") == std::string::npos);
    CHECK(has(swarm.log("face"), "connected image from camera.image"));
}

TEST_CASE("--connect: mistakes are refused at the start, in one sentence and with their exit code")
{
    const Swarm swarm;
    struct Mistake {
        const char *kind, *connect;
        int exit_code;
        std::vector<const char*> said;
    };
    for (const auto& mistake : {Mistake{"face", "image=camera", 2, {"--connect image=camera", "names no output"}},
                                Mistake{"face", "image=camera.image,widow=2", 2, {"window=N"}},
                                Mistake{"face", "imago=camera.image", 3, {"did you mean image"}},
                                Mistake{"annotate", "camera.image", 2, {"several inputs"}},
                                Mistake{"ticker", "camera.image", 3, {"has no input"}},
                                Mistake{"sleeper", "refused.result", 2, {"own output"}},
                                Mistake{"counter", "source.tick,share", 5, {"keeps state"}},
                                Mistake{"sleeper", "source.tick,at=tcp://0.0.0.0:7700", 2, {"cannot dial"}}}) {
        CAPTURE(mistake.connect);
        const auto finished = refused(swarm, mistake.kind, mistake.connect);
        CHECK(finished.exit_code == mistake.exit_code);
        for (const auto* part : mistake.said)
            CHECK_MESSAGE(has(finished.err, part), finished.err);
    }
    const auto twice = swarm.run({swarm.program("hive-sleeper").string(), "--name", "refused", "--connect",
                                  "source.tick", "--connect", "image=source.tick,window=2"});
    CHECK(twice.exit_code == 2);
    CHECK(has(twice.err, "given twice"));
    CHECK(swarm.hivectl_done({"ps", "--json"}) == "[]\n");
}

TEST_CASE("--connect: what the sender refuses is said in ps and once in the log, until another sender has come")
{
    const Swarm swarm;
    auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto face = swarm.drone("face", "face", {}, {"--connect", "image=source.image"});
    const auto worker = swarm.drone("face", "worker", {}, {"--connect", "image=source.tick"});
    CHECK(
        eventually([&] { return has(note_of(swarm, "face"), "refused the connection: source has no output image"); }));
    CHECK(eventually([&] { return has(note_of(swarm, "worker"), "application/octet-stream"); }));
    auto application = swarm.application();
    CHECK(application.status("face").inputs.at(0).why == hive::Reason::refused);
    const auto first = application.status("face").inputs.at(0).registration;
    CHECK(eventually([&] { return application.status("face").inputs.at(0).registration > first; }));
    const auto log = swarm.log("face");
    CHECK(log.find("refused image from") == log.rfind("refused image from"));
    CHECK(log.find("refused image from") != std::string::npos);
    source.kill();
    const auto camera = swarm.drone("camera", "source");
    CHECK(eventually([&] { return application.status("face").inputs.at(0).connected; }));
}

TEST_CASE("--connect: members of one group share the work, whoever is killed")
{
    const Swarm swarm;
    const Words sharing{"--connect", "image=source.tick,share"};
    auto first = swarm.drone("sleeper", "one", {"work_ms=1"}, sharing);
    const auto second = swarm.drone("sleeper", "two", {"work_ms=1"}, sharing);
    const auto source = swarm.drone("ticker", "source", {"fps=200"});
    auto application = swarm.application();
    for (const auto* name : {"one", "two"}) {
        CHECK(receives(application, name));
        CHECK(application.status(name).inputs.at(0).options.group == "source");
    }
    first.kill();
    first = swarm.drone("sleeper", "one", {"work_ms=1"}, sharing);
    CHECK(receives(application, "one"));
    CHECK(receives(application, "two"));
}

TEST_CASE("--connect: across two machines by tcp, whichever is there first, and again after each was killed")
{
    const Swarm far, near;
    const auto address = "tcp://127.0.0.1:" + std::to_string(free_port());
    const Words listening{"--listen", address, "--insecure"};
    const Words connecting{"--connect", "image=source.tick,at=" + address, "--insecure"};
    auto worker = near.drone("sleeper", "worker", {"work_ms=1"}, connecting);
    auto source = far.drone("ticker", "source", {"fps=100"}, listening);
    auto application = near.application();
    CHECK(receives(application, "worker"));
    source.kill();
    source = far.drone("ticker", "source", {"fps=100"}, listening);
    CHECK(receives(application, "worker"));
    worker.kill();
    worker = near.drone("sleeper", "worker", {"work_ms=1"}, connecting);
    CHECK(receives(application, "worker"));
}

TEST_CASE("--connect: after a crash it wins over what was remembered of the same ends, and the rest is remembered")
{
    const Swarm swarm;
    const Words words{"--connect", "image=source.tick,window=2"};
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto other = swarm.drone("ticker", "other", {"fps=100"});
    auto worker = swarm.drone("sleeper", "worker", {"work_ms=1"}, words);
    auto application = swarm.application();
    REQUIRE(receives(application, "worker"));
    application.connect({"source", "tick"}, {"worker", "image"}, {.window = 5, .group = {}, .lease = {}});
    application.connect({"other", "tick"}, {"worker", "image"}, {.window = 7, .group = {}, .lease = {}});
    const auto windows = [&] {
        std::map<std::string, int> found;
        for (const auto& input : application.status("worker").inputs)
            if (input.connected)
                found.emplace(input.from, input.options.window);
        return found;
    };
    using Windows = std::map<std::string, int>;
    REQUIRE(windows() == Windows{{"source.tick", 5}, {"other.tick", 7}});
    worker.kill();
    worker = swarm.drone("sleeper", "worker", {"work_ms=1"}, words);
    CHECK(eventually([&] { return windows() == Windows{{"source.tick", 2}, {"other.tick", 7}}; }));
    CHECK(application.status("worker").inputs.size() == 2);
    worker.kill();
    worker = swarm.drone("sleeper", "worker", {"work_ms=1"});
    CHECK(eventually([&] { return windows() == Windows{{"source.tick", 2}, {"other.tick", 7}}; }));
}

TEST_CASE("--connect: hivectl start hands it on")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    CHECK(swarm.hivectl_done({"start", "sleeper", "--as", "worker", "--connect", "source.tick,window=3", "work_ms=1"})
          == "worker\n");
    auto application = swarm.application();
    CHECK(receives(application, "worker"));
    CHECK(application.status("worker").inputs.at(0).options.window == 3);
    CHECK(application.get("worker", {"work_ms"}) == Json{{"work_ms", 1}});
    const auto wrong = swarm.hivectl({"start", "sleeper", "--as", "other", "--connect", "nonsense"});
    CHECK(wrong.exit_code == 2);
    CHECK(has(wrong.err, "names no output"));
    swarm.hivectl_done({"stop", "worker"});
}
