// A recorder whose disk is full: hivectl audit counts what was lost, hivectl explain names the disk and the command
// that continues.
#include "explained.hpp"

#include <possible.hpp>

#include <filesystem>
#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

namespace fs = std::filesystem;

Json row_to(const Swarm& swarm, const std::string& receiver, int exit_code)
{
    const auto done = swarm.hivectl({"audit", "--json"});
    CHECK_MESSAGE(done.exit_code == exit_code, done.out);
    for (auto& row : Json::parse(done.out))
        if (row.at("to") == receiver)
            return row;
    return {};
}

}  // namespace

TEST_CASE("explain and audit: a recorder whose disk is full, and which continues once there is space")
{
    const Swarm swarm;
    if (!possible(swarm.run({"/usr/bin/unshare", "-Urm", "/bin/true"}).exit_code == 0
                      ? ""
                      : "the right to mount a file system"))
        return;
    const auto disk = swarm.home() / "disk", free = swarm.home() / "free";
    fs::create_directory(disk);
    const auto camera = swarm.drone("camera", "camera", {"fps=30", "width=160", "height=120"});
    const auto started =
        swarm.run({"/usr/bin/unshare", "-Urm", "/bin/sh", "-c",
                   "mount -t tmpfs -o size=16m small " + disk.string() + " && head -c 12000000 /dev/zero > "
                       + disk.string() + "/filler && hivectl start record file=" + disk.string()
                       + "/run.hive || exit 1; (while [ ! -e " + free.string() + " ]; do sleep 0.05; done; rm "
                       + disk.string() + "/filler " + free.string() + ") > /dev/null 2>&1 &"});
    REQUIRE_MESSAGE(started.exit_code == 0, started.err);
    swarm.hivectl_done({"connect", "camera", "record", "--window", "8"});
    CHECK(row_to(swarm, "record.events", 0).at("verdict") == "ok");

    const auto full = awaited(swarm, "explain", "condition record");
    CHECK(full.exit_code == 9);
    const auto file = disk / "run.hive", next = disk / "run-2.hive";
    CHECK_MESSAGE(has(full.text(), "record reports: disk full: " + file.string()), full.text());
    CHECK_MESSAGE(has(full.evidence(), " events abandoned"), full.text());
    CHECK(full.command() == "hivectl set record file=" + next.string());
    const auto row = row_to(swarm, "record.events", 9);
    CHECK_MESSAGE(row.at("verdict") == "lost", row.dump(2));
    const auto loss = row.at("losses").back();
    CHECK(loss.at("fate") == "abandoned");
    CHECK(loss.at("at") == "record");
    CHECK(loss.at("events") == row.at("lost"));
    CHECK(loss.at("reason") == "disk full: " + file.string());
    CHECK(has(swarm.hivectl({"audit", "--wide"}).out, "abandoned at record (last: disk full: " + file.string() + ")"));
    const Shell shell(swarm);
    std::ofstream(free) << "";
    REQUIRE(eventually([&] { return !fs::exists(free); }));
    cure(shell, full);
    CHECK(runs(shell, "explain"));
    auto application = swarm.application();
    const auto before = application.status("record").inputs.at(0);
    REQUIRE(eventually([&] { return processed(application, "record") > before.processed + 10; }));
    CHECK(application.status("record").inputs.at(0).abandoned == before.abandoned);
    CHECK(application.get("record", {"file"}).at("file") == next.string());
}
