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

/// A file system of 16 MB, 12 of them full, and a recorder, which alone sees what is on it.
class SmallDisk {
public:
    static std::string missing(const Swarm& swarm)
    {
        return swarm.run({"/usr/bin/unshare", "-Urm", "/bin/true"}).exit_code == 0 ? ""
                                                                                   : "the right to mount a file system";
    }
    explicit SmallDisk(const Swarm& swarm) : swarm_(swarm), path_(swarm.home() / "disk")
    {
        fs::create_directory(path_);
        const auto started = swarm.run(
            {"/usr/bin/unshare", "-Urm", "/bin/sh", "-c",
             "mount -t tmpfs -o size=16m small $0 && head -c 12000000 /dev/zero > $0/filler && hivectl start record "
             "file=$0/run.hive",
             path_.string()});
        REQUIRE_MESSAGE(started.exit_code == 0, started.err);
    }
    [[nodiscard]] const fs::path& path() const { return path_; }
    /// Runs a shell command where the recorder is; $0 is the path.
    [[nodiscard]] Finished run(const std::string& line) const
    {
        const auto pid = std::to_string(swarm_.application().status("record").pid);
        return swarm_.run({"/usr/bin/nsenter", "--target", pid, "--user", "--mount", "--preserve-credentials",
                           "/bin/sh", "-c", line, path_.string()});
    }
    void make_space() const { REQUIRE(run("rm $0/filler").exit_code == 0); }

private:
    const Swarm& swarm_;
    fs::path path_;
};

constexpr const char* still_waiting = "still waiting when the drone was stopped";

/// The exit code tells whether the file is still being written.
Json info_of(const SmallDisk& disk, const std::string& file)
{
    return Json::parse(disk.run("hivectl replay $0/" + file + ".hive --info --json").out);
}

}  // namespace

TEST_CASE("explain and audit: a recorder whose disk is full, and which continues once there is space")
{
    const Swarm swarm;
    if (!injectable(SmallDisk::missing(swarm)))
        return;
    const auto camera = swarm.drone("camera", "camera", {"fps=30", "width=160", "height=120"});
    const SmallDisk disk(swarm);
    swarm.hivectl_done({"connect", "camera", "record", "--window", "8"});
    CHECK(row_to(swarm, "record.events", 0).at("verdict") == "ok");

    const auto full = awaited(swarm, "explain", "condition record");
    CHECK(full.exit_code == 9);
    const auto file = disk.path() / "run.hive", next = disk.path() / "run-2.hive";
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
    disk.make_space();
    cure(shell, full);
    CHECK(runs(shell, "explain"));
    auto application = swarm.application();
    const auto before = application.status("record").inputs.at(0);
    REQUIRE(eventually([&] { return processed(application, "record") > before.processed + 10; }));
    CHECK(application.status("record").inputs.at(0).abandoned == before.abandoned);
    CHECK(application.get("record", {"file"}).at("file") == next.string());
}

TEST_CASE(
    "replace: a recorder whose disk is full: each acknowledged event is in a recording, or is counted there as lost")
{
    const Swarm swarm;
    if (!injectable(SmallDisk::missing(swarm)))
        return;
    const auto camera = swarm.drone("camera", "camera", {"fps=30", "width=160", "height=120"});
    const SmallDisk disk(swarm);
    swarm.hivectl_done({"connect", "camera", "record", "--window", "8"});
    auto application = swarm.application();
    const auto abandons = [&] { return application.status("record").inputs.at(0).abandoned > 5; };
    const auto replace = [&] {
        const auto before = application.status("record").pid;
        const auto done = disk.run("hivectl replace record --lose-state");
        CHECK_MESSAGE(done.exit_code == 0, done.err);
        CHECK(application.status("record").pid != before);
    };
    REQUIRE(eventually(abandons));
    replace();
    REQUIRE(eventually(abandons));
    disk.make_space();
    replace();
    REQUIRE(eventually([&] { return application.status("record").inputs.at(0).processed > 5; }));
    application.halt("camera");
    const auto edge = [&] { return application.status("camera").outputs.at(0).edges.at(0); };
    REQUIRE(eventually([&] { return edge().events.in_flight() == 0 && edge().waiting == 0; }));
    std::int64_t lost = 0, waited = 0;
    const auto recorded_or_lost = [&] {
        std::int64_t recorded = 0;
        lost = waited = 0;
        for (const std::string file : {"run", "run-2", "run-3"}) {
            const auto info = info_of(disk, file);
            CHECK_MESSAGE(info.at("events").get<int>() + static_cast<int>(info.at("lost").size()) > 0, info.dump());
            recorded += info.at("events").get<std::int64_t>();
            for (const auto& one : info.at("lost")) {
                CHECK_MESSAGE((one.at("reason") == "disk full" || one.at("reason") == still_waiting), info.dump());
                (one.at("reason") == "disk full" ? lost : waited) += one.at("events").get<std::int64_t>();
            }
        }
        return recorded + lost;
    };
    // While the recorder is replaced, a live source skips events. One that is in transit or queued then is lost with
    // the connection: no recorder has received it, or the old one lists it as waiting.
    const auto sent = edge().events;
    const auto acknowledged = sent.of(hive::Fate::acknowledged), cut = sent.of(hive::Fate::lost_connection);
    CHECK_MESSAGE(eventually([&] { return recorded_or_lost() == acknowledged; }), recorded_or_lost(), " of ",
                  acknowledged, swarm.hivectl({"connections", "--json"}).out);
    CHECK(waited <= cut);
    CHECK(sent.total() == acknowledged + cut + sent.of(hive::Fate::skipped));
    CHECK(lost > 10);
}

TEST_CASE("replace: a recorder that was halted with a full disk lists the events that wait for it")
{
    const Swarm swarm;
    if (!injectable(SmallDisk::missing(swarm)))
        return;
    const auto camera = swarm.drone("camera", "camera", {"fps=30", "width=160", "height=120"});
    const SmallDisk disk(swarm);
    swarm.hivectl_done({"connect", "camera", "record", "--window", "8"});
    auto application = swarm.application();
    const auto input = [&] { return application.status("record").inputs.at(0); };
    REQUIRE(eventually([&] { return input().abandoned > 5; }));
    application.halt("record");
    REQUIRE(eventually([&] { return input().queued >= 7 && input().in_hand == 0; }));  // 7: one ended after the halt
    std::this_thread::sleep_for(Milliseconds(300));
    const auto queued = input().queued;
    const auto done = disk.run("hivectl replace record --lose-state");
    CHECK_MESSAGE(done.exit_code == 0, done.err);
    const auto waited = [&] {
        std::int64_t events = 0;
        const auto info = info_of(disk, "run");
        for (const auto& one : info.at("lost"))
            events += one.at("reason") == still_waiting ? one.at("events").get<std::int64_t>() : 0;
        return events;
    };
    CHECK(eventually(
        [&] { return waited() == queued; }));  // the old process writes its end after the new one has started
}
