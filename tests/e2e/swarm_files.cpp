// Swarm files on the command line: check and schema, and the files in scripts/swarms/.
#include "swarm.hpp"

#include <hive/swarm_plan.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;
using namespace std::chrono_literals;

namespace {

namespace fs = std::filesystem;

fs::path written(const Swarm& swarm, const std::string& name, const std::string& text)
{
    const auto file = swarm.home() / name;
    std::ofstream(file) << text;
    return file;
}

}  // namespace

TEST_CASE("swarm files: those in scripts/swarms are good")
{
    const Swarm swarm;
    int files = 0;
    for (const auto& entry : fs::directory_iterator(HIVE_SOURCE_DIR "/scripts/swarms"))
        if (entry.path().extension() == ".json") {
            ++files;
            const auto checked = swarm.hivectl({"check", entry.path().string(), "--timeout", "60"}, patient(15'000ms));
            CHECK_MESSAGE(checked.exit_code == 0, checked.out, checked.err);
            CHECK_MESSAGE(checked.out.starts_with(entry.path().stem().string() + ": good, "), checked.out);
            CHECK_EQ(checked.err, "");
            auto script = entry.path();
            CHECK_MESSAGE(fs::exists(script.replace_extension(".sh")), script);
        }
    CHECK_EQ(files, 5);
}

TEST_CASE("swarm files: a drone that is dropped for its name is checked by its own kind")
{
    const Swarm swarm;
    const auto check = [&](const std::string& text) {
        return swarm.hivectl({"check", written(swarm, "twice.json", text).string(), "--timeout", "60"},
                             patient(15'000ms));
    };
    const auto one = check(R"({"swarm":"s","drones":{"c":{"kind":"camera","count":2},"c-2":{"kind":"face"}}})");
    CHECK_EQ(one.exit_code, 2);
    CHECK_MESSAGE(one.out.find(":1:56: two drones are called c-2; ") != std::string::npos, one.out, one.err);
    const auto other =
        check(R"({"swarm":"s","drones":{"c":{"kind":"face","count":2},"c-2":{"kind":"camera","set":{"fps":3}}}})");
    CHECK_EQ(std::ranges::count(other.out, '\n'), 1);
    CHECK_MESSAGE(other.out.find("two drones are called c-2") != std::string::npos, other.out, other.err);
}

TEST_CASE("swarm files: every mistake is a line to which an editor jumps, and the exit code is 2")
{
    const Swarm swarm;
    const auto file = written(swarm, "bad.json", R"({"swarm": "s", "drones": {
  "camera": {"kind": "camera", "set": {"fps": "fast"}},
  "face": {"kind": "face"}
}, "connections": [
  {"from": "camera.imag", "to": "face"},
  {"from": "face.faces", "to": "face-2"}
]})")
                          .string();
    const auto checked = swarm.hivectl({"check", file, "--timeout", "60"}, patient(15'000ms));
    CHECK_EQ(checked.exit_code, 2);
    CHECK_EQ(checked.out, file + ":2:47: fps=\"fast\": must be a number, 0 to 1000 fps\n" + file
                              + ":5:33: camera has no output imag; did you mean image?\n" + file
                              + ":6:32: there is no drone \"face-2\" in this file; did you mean face?\n");
    const auto rows = Json::parse(swarm.hivectl({"check", file, "--json", "--timeout", "60"}, patient(15'000ms)).out);
    REQUIRE_EQ(rows.size(), 3u);
    CHECK_EQ(rows[1], Json{{"file", file},
                           {"line", 5},
                           {"column", 33},
                           {"at", "connections[0].to"},
                           {"text", "camera has no output imag"},
                           {"advice", "did you mean image?"}});
}

TEST_CASE("export --from: names and globs choose drones of the file, and one without a match is refused")
{
    const Swarm swarm;
    const auto file = written(swarm, "lab.json", R"({"swarm": "s", "drones": {
  "source": {"kind": "ticker", "on": "n1", "insecure": true},
  "worker": {"kind": "sleeper", "count": 2, "on": ["n1", "n2"], "insecure": true}},
  "connections": [{"from": "source.tick", "to": "worker-*.image"}],
  "engines": {"n1": {"ssh": "one"}, "n*": {"ssh": "other"}}})")
                          .string();
    const auto exported = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"export", "--from", file});
        return swarm.hivectl(words, patient(15'000ms));
    };
    const auto plan_of = [&](const std::vector<std::string>& words) {
        const auto done = exported(words);
        CHECK_MESSAGE(done.exit_code == 0, done.err);
        const auto reading = hive::read_swarm(done.out);
        CHECK_MESSAGE(reading.mistakes.empty(), done.out);
        return reading.plan;
    };
    const auto workers = plan_of({"worker-*"});
    CHECK_EQ(workers.drones.size(), 2u);
    CHECK(workers.drone("worker-2"));
    CHECK(workers.connections.empty());
    const auto first = plan_of({"worker-1", "source"});  // "n*" without n2 would be a mistake
    CHECK_EQ(first.drones.size(), 2u);
    REQUIRE_EQ(first.connections.size(), 1u);
    CHECK_EQ(first.connections[0].to.drone, "worker-1");
    CHECK_EQ(exported({"source", "--as", "shell"}).out.find("sleeper"), std::string::npos);

    const auto some = exported({"wroker-1", "source"});
    CHECK_EQ(some.exit_code, 8);
    CHECK_EQ(hive::read_swarm(some.out).plan.drones.size(), 1u);
    CHECK_EQ(some.err, "hivectl export: no drone matches \"wroker-1\" in " + file + "; did you mean worker-1?\n");
    for (const std::string form : {"", "shell"}) {
        auto words = std::vector<std::string>{"nosuch*"};
        if (!form.empty())
            words.insert(words.end(), {"--as", form});
        const auto none = exported(words);
        CHECK_EQ(none.exit_code, 3);
        CHECK_EQ(none.out, "");
    }
}

TEST_CASE("swarm files: one comes on stdin, and one that is not there is no mistake of JSON")
{
    const Swarm swarm;
    const auto checked =
        swarm.run({"/bin/sh", "-c", "echo '{\"swarm\": \"s\", \"drones\": {}} # done' | hivectl check -"});
    CHECK_EQ(checked.exit_code, 2);
    CHECK_EQ(checked.out, "<stdin>:1:30: comments start with // and end with the line\n");
    const auto missing = swarm.hivectl({"check", (swarm.home() / "none.json").string()});
    CHECK_EQ(missing.exit_code, 1);
    CHECK(missing.err.find("No such file") != std::string::npos);
    CHECK_EQ(swarm.hivectl({"check", swarm.home().string()}).exit_code, 1);
}

TEST_CASE("swarm files: what up would refuse on this machine is found by check and up --dry-run")
{
    const Swarm swarm;
    const auto file = written(swarm, "away.json", R"({"swarm": "s", "drones": {"a":
  {"kind": "ticker", "listen": "tcp://192.0.2.1", "insecure": true}}})")
                          .string();
    for (const auto& words : {std::vector<std::string>{"check", file}, {"up", file, "--dry-run"}, {"up", file}}) {
        const auto refused = swarm.hivectl(words, patient(15'000ms));
        CHECK_EQ(refused.exit_code, words[0] == "check" ? 2 : 5);
        CHECK_MESSAGE((refused.out + refused.err).find(":2:32: \"tcp://192.0.2.1\": this machine does not have this")
                          != std::string::npos,
                      refused.out, refused.err);
    }
    const auto slurm = written(swarm, "slurm.json",
                               R"({"swarm": "s", "drones": {"a": {"kind": "ticker", "on": "n1", "insecure": true}},
  "engines": {"n1": {"slurm": {}}}})")
                           .string();
    CHECK_EQ(swarm.hivectl({"check", slurm}, patient(15'000ms)).exit_code, 0);  // it may be meant for an allocation
    for (const std::string how : {" --dry-run", ""}) {
        const auto refused =
            swarm.run({"/bin/sh", "-c", "unset SLURM_JOB_ID; hivectl up " + slurm + how}, patient(15'000ms));
        CHECK_EQ(refused.exit_code, 5);
        CHECK_MESSAGE(refused.err.find("the drones on n1 need a Slurm allocation") != std::string::npos, refused.err);
    }
}

TEST_CASE("swarm files: a kind that is not here is a note for another machine, and programs that say nothing are not "
          "waited for")
{
    const Swarm swarm;
    const auto elsewhere =
        written(swarm, "elsewhere.json",
                R"({"swarm": "s", "drones": {"a": {"kind": "nosuch", "on": "cam1", "insecure": true}}})")
            .string();
    const auto checked = swarm.hivectl({"check", elsewhere}, patient(15'000ms));
    CHECK_EQ(checked.exit_code, 0);
    CHECK_EQ(checked.out, "s: good, 1 drone on 1 machine, 0 connections\n");
    CHECK(checked.err.find(elsewhere + ":1:41: parameters and ports of nosuch are not checked: ") != std::string::npos);
    const auto silent = written(swarm, "hive-silent", "#!/bin/sh\nexec sleep 60\n");
    fs::permissions(silent, fs::perms::owner_all);
    const auto file = written(swarm, "silent.json", R"({"swarm": "s", "drones": {"a": {"kind": "silent"}}})").string();
    const auto late = swarm.run({"/bin/sh", "-c", "HIVE_DRONE_PATH=$HIVE_HOME hivectl check --timeout 0.5 " + file},
                                patient(15'000ms));
    CHECK_EQ(late.exit_code, 2);
    CHECK(late.out.find(":1:41: ") != std::string::npos);
    CHECK(late.out.find("has not answered in time") != std::string::npos);
}

TEST_CASE("swarm files: hivectl prints the schema of the repository")
{
    const Swarm swarm;
    std::ostringstream schema;
    schema << std::ifstream(HIVE_SOURCE_DIR "/libhive/manager/swarm.schema.json").rdbuf();
    CHECK_EQ(swarm.hivectl_done({"schema"}), schema.str());
}
