// Whole swarms as steps of a Slurm allocation, on a cluster of three nodes on this machine. Without Slurm the tests are
// skipped.
#include "free_port.hpp"
#include "slurm_lab.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// A source on one node, and workers on the two others, which share it.
Json shared_work()
{
    return {{"swarm", "work"},
            {"drones",
             {{"source", {{"kind", "ticker"}, {"on", "n1"}, {"set", {{"fps", 50}}}}},
              {"worker", {{"kind", "sleeper"}, {"count", 4}, {"on", {"n2", "n3"}}, {"set", {{"work_ms", 1}}}}}}},
            {"connections", {{{"from", "source"}, {"to", "worker-*"}, {"share", true}}}},
            {"engines", {{"n*", {{"slurm", {{"options", {"--mem=0"}}}}}}}}};
}

std::string write(const SlurmLab& lab, const Json& content)
{
    const auto file = (lab.swarm().home() / "work.json").string();
    std::ofstream(file) << content.dump(2);
    return file;
}

const std::vector<std::string> all{"source", "worker-1", "worker-2", "worker-3", "worker-4"};

}  // namespace

TEST_CASE("up under slurm: a swarm on three nodes, each drone a step, what fell is started again, scancel ends it")
{
    if (!possible(missing_for_slurm()))
        return;
    const SlurmLab lab;
    lab.shell_done("hivectl key new");
    auto content = shared_work();
    content["drones"]["source"]["listen"] = "tcp://0.0.0.0";  // at a port that the engine chooses
    content["drones"]["source"]["cpus"] = 1;
    content["engines"]["n*"]["slurm"]["job"] = {"--requeue"};  // not for srun
    const auto up = "hivectl up " + write(lab, content);
    CHECK(lines_of(lab.shell_done(up)) == 5 + 4);
    CHECK(lab.steps() == all);
    CHECK(lab.processes("n1") == 1);
    CHECK(lab.processes("n2") == 2);
    for (const auto& row : Json::parse(lab.shell_done("hivectl ps --json")))
        CHECK(row.at("host")
              == (row.at("name") == "source"                                     ? "n1"
                  : row.at("name") == "worker-1" || row.at("name") == "worker-3" ? "n2"
                                                                                 : "n3"));
    CHECK(lines_of(lab.shell_done("hivectl results 'worker-*' -n 8")) == 8);
    CHECK(has(lab.shell_done("hivectl logs source"), "listening on tcp://"));
    CHECK(lab.shell_done(up).empty());

    lab.shell_done("scancel --signal=KILL $(squeue -s -h -j $SLURM_JOB_ID -o '%i %j' | grep worker-2 | cut -d' ' -f1)");
    REQUIRE(eventually([&] { return lab.steps().size() == 4; }, 20'000ms));
    CHECK(has(lab.shell_done(up), "start worker-2"));
    CHECK(lab.steps() == all);
    lab.shell_done("scancel " + lab.job());
    CHECK(eventually([&] { return lab.processes() == 0; }, 20'000ms));
    CHECK(lines_of(lab.shell_done("hivectl down")) == 5);
    CHECK(lab.shell_done("hivectl place list --json") == "[]\n");
}

TEST_CASE("up under slurm: a killed up leaves what the next one finds, and one that fails leaves nothing")
{
    if (!possible(missing_for_slurm()))
        return;
    const SlurmLab lab;
    lab.shell_done("hivectl key new");
    auto content = shared_work();
    const auto file = write(lab, content);
    auto killed = lab.hivectl_running({"up", file}, "up");
    REQUIRE(eventually([&] { return lab.processes() > 1; }, 20'000ms));
    killed.kill();
    lab.shell_done("hivectl up " + file);
    CHECK(lab.steps() == all);
    CHECK(eventually([&] { return lab.processes() == 5; }, 10'000ms));

    content["drones"]["zlast"] = {{"kind", "ticker"}, {"on", "n4"}};
    write(lab, content);
    const auto unknown = lab.shell("hivectl up " + file);
    CHECK(unknown.exit_code == 5);
    CHECK_MESSAGE(has(unknown.err, "Slurm has no node n4"), unknown.err);
    content["drones"]["zlast"] = {{"kind", "ticker"}, {"on", "n3"}, {"key", "/no/such/key"}};
    content["drones"]["more"] = {{"kind", "sleeper"}, {"on", "n1"}};
    write(lab, content);
    const auto refused = lab.shell("hivectl up " + file);
    CHECK(refused.exit_code == 5);
    CHECK_MESSAGE(has(refused.err, "/no/such/key"), refused.err);
    CHECK(eventually([&] { return lab.steps() == all; }, 10'000ms));

    content = shared_work();
    content["drones"]["worker"]["log_level"] = "debug";
    write(lab, content);
    for (const std::string how : {" --dry-run", ""}) {
        const auto restart = lab.shell("unset SLURM_JOB_ID; hivectl up " + file + how);
        CHECK(restart.exit_code == 5);
        CHECK_MESSAGE(has(restart.err, "need a Slurm allocation"), restart.err);
        CHECK(lab.steps() == all);  // a drone that cannot be restarted from there is not stopped
    }
    CHECK(lines_of(lab.shell_done("hivectl down")) == 5);
    CHECK(eventually([&] { return lab.steps().empty() && lab.processes() == 0; }, 10'000ms));
    const auto outside = lab.swarm().hivectl({"up", file});
    CHECK(outside.exit_code == 5);
    CHECK_MESSAGE(has(outside.err, "allocation"), outside.err);
}

TEST_CASE("up under slurm: in a heterogeneous job each drone is a step of the component that has its node")
{
    if (!possible(missing_for_slurm()))
        return;
    SlurmLab lab;
    lab.shell_done("hivectl key new");
    Json content{
        {"swarm", "mixed"},
        {"drones", {{"a", {{"kind", "ticker"}, {"on", "n1"}}}, {"b", {{"kind", "sleeper"}, {"on", "n2"}}}}},
        {"connections", {{{"from", "a"}, {"to", "b"}}}},
        {"engines", {{"n1", {{"slurm", Json::object()}}}, {"n2", {{"slurm", {{"options", {"--gres=gpu:1"}}}}}}}}};
    const auto home = lab.swarm().home();
    const auto script = home / "mixed.sbatch";
    std::ofstream(script) << "#!/bin/bash\n#SBATCH --nodes=1 --nodelist=n1\n#SBATCH hetjob\n"
                             "#SBATCH --nodes=1 --nodelist=n2 --gres=gpu:1\n"
                          << "export HIVE_HOME=" << home.string() << "\nhivectl up " << write(lab, content)
                          << " && hivectl results b -n 3 --timeout 20 && squeue --noheader --steps --format='%j on %N'"
                             "\nkill -STOP $(hivectl ps b --json | grep -o '\"pid\":[0-9]*' | cut -d: -f2)\n"
                             "hivectl down --timeout 1 && echo all done\n";
    lab.submit(script);
    const auto said = [&] { return lab.swarm().log("sbatch"); };
    REQUIRE_MESSAGE(eventually([&] { return has(said(), "all done"); }, 60'000ms), said());
    CHECK(has(said(), "a on n1"));
    CHECK(has(said(), "b on n2"));
    CHECK_MESSAGE(eventually([&] { return lab.processes() == 0; }, 10'000ms), said());
}

TEST_CASE("export as slurm: sbatch brings the swarm up on three nodes, a killed drone comes back, scancel ends it")
{
    if (!possible(missing_for_slurm()))
        return;
    SlurmLab lab;
    lab.shell_done("hivectl key new");
    // The nodes are one machine here, whose ports they share.
    std::map<std::string, std::string> addresses;
    for (const auto& name : all)
        addresses[name] = "tcp://127.0.0.1:" + std::to_string(free_port());
    auto content = shared_work();
    auto& drones = content["drones"];
    drones = {{"source", {{"kind", "ticker"}, {"on", "n1"}, {"set", {{"fps", 50}}}}}};
    for (std::size_t i = 1; i < all.size(); ++i)
        drones[all[i]] = {{"kind", "sleeper"}, {"on", i % 2 == 1 ? "n2" : "n3"}, {"restart", "on-failure"}};
    for (const auto& [name, address] : addresses)
        drones[name]["listen"] = address;
    for (const char* name : {"worker-1", "worker-3"})  // on one node
        drones[name].update({{"cpus", 2}, {"gpus", 1}});
    const auto options = [](const std::string& more) {
        return Json{{"slurm", {{"options", {"--mem=0", more}}, {"job", {"--time=60", "--signal=B:TERM@60"}}}}};
    };
    const std::string comment = R"(so#u 'r' "c" \ $HOME;)";
    content["engines"] = {{"n1", options("--comment=" + comment)}, {"n2", options("--comment=workers")}};
    content["engines"]["n3"] = content["engines"]["n2"];
    lab.shell_done("hivectl export --from " + write(lab, content) + " --as slurm --to $HIVE_HOME");
    lab.submit(lab.swarm().home() / "work.sbatch");
    REQUIRE_MESSAGE(eventually([&] { return lab.steps() == all && lab.processes() == 5; }, 90'000ms),
                    lab.swarm().log("sbatch"));
    const auto comments = lab.shell_done("squeue --noheader --format=%N,%k");  // sbatch gives nodes only their options
    CHECK_MESSAGE(has(comments, "n1," + comment), comments);
    const auto jobs = lab.shell_done("scontrol show jobs");
    CHECK_MESSAGE(has(jobs, "TimeLimit=01:00:00"), jobs);
    // Each has its own, and the others none.
    const auto given = lab.shell_done("scontrol --oneliner show steps");
    std::istringstream lines(given);
    for (std::string line; std::getline(lines, line);)
        if (has(line, "Name=worker-1 ") || has(line, "Name=worker-3 "))
            CHECK_MESSAGE((has(line, "TRES=cpu=2,") && has(line, "gres:gpu:1")), line);
        else
            CHECK_FALSE_MESSAGE(has(line, "gres:gpu"), line);
    CHECK_MESSAGE(has(comments, "n[2-3],workers"), comments);
    CHECK(lab.processes("n1") == 1);
    CHECK(lab.processes("n2") == 2);
    for (const auto& [name, address] : addresses)
        CHECK_MESSAGE(
            eventually([&] { return lab.shell("hivectl place add " + name + " " + address).exit_code == 0; }, 20'000ms),
            name);
    const auto works = [&] {
        for (const auto& name : all)
            if (name != "source")
                CHECK_MESSAGE(lab.shell("hivectl results " + name + " -n 3 --timeout 30").exit_code == 0, name);
    };
    works();
    const auto pid_of = [&](const std::string& name) {
        for (const auto& row : Json::parse(lab.shell_done("hivectl ps --json")))
            if (row.at("name") == name && row.at("pid").is_number())
                return row.at("pid").get<pid_t>();
        return 0;
    };
    const auto killed = pid_of("worker-2");
    REQUIRE(killed > 1);
    ::kill(killed, SIGKILL);
    CHECK(eventually(
        [&] {
            const auto now = pid_of("worker-2");
            return now != 0 && now != killed;
        },
        30'000ms));
    CHECK(eventually([&] { return lab.steps() == all; }, 10'000ms));
    works();
    // As before the time limit: what would otherwise be restarted ends, too.
    lab.shell_done("scancel --batch --signal=TERM " + lab.job());
    CHECK(eventually([&] { return lab.steps().empty() && lab.processes() == 0; }, 20'000ms));
    CHECK(eventually([&] { return lab.shell_done("squeue --noheader").empty(); }, 20'000ms));
}
