// Exported swarms: each form passes the validator of its engine, if that is installed.
#include "swarm.hpp"

#include <hive/program.hpp>
#include <hive/swarm_export.hpp>

#include <doctest/doctest.h>
#include <possible.hpp>

#include <fstream>
#include <map>

using namespace hive;
using namespace hive::test;
using namespace std::chrono_literals;

namespace {

namespace fs = std::filesystem;

/// Each kind is asked once.
SwarmPlan plan_of(const std::string& text)
{
    static std::map<std::string, Interface> known;
    const auto reading = read_swarm(text, [](const std::string& kind) {
        auto found = known.find(kind);
        if (found == known.end())
            found = known.emplace(kind, interface_of(kind, patient(15'000ms))).first;
        return found->second;
    });
    for (const auto& mistake : reading.mistakes)
        FAIL_CHECK(mistake.at << ": " << mistake.text);
    return reading.plan;
}

/// The ready-made swarms, and one on several machines.
std::vector<SwarmPlan> plans(const std::string& form)
{
    std::vector<SwarmPlan> all;
    for (const auto& entry : fs::directory_iterator(HIVE_SOURCE_DIR "/scripts/swarms"))
        if (entry.path().extension() == ".json")
            all.push_back(plan_of(text_of(entry.path())));
    all.push_back(plan_of(R"({"swarm": "lab", "drones": {
        "camera": {"kind": "camera", "on": "cam1", "set": {"source": "/dev/video0", "credentials": "a b$c%d\"e'"}},
        "face": {"kind": "face", "count": 3, "on": ["gpu1", "gpu2"], "restart": "on-failure"},
        "background": {"kind": "background", "restart": "always", "cpus": 2, "memory_mib": 512, "gpus": 1},
        "record": {"kind": "record", "set": {"file": "/data/a \"#$x'%/run.hive"}}},
      "connections": [{"from": "camera", "to": "face-*", "share": true},
                      {"from": "camera", "to": ["background", "record"], "encoding": "jpeg:60"}],
      "engines": {"gpu*": {"slurm": {"partition": "gpu", "options": ["--constraint=a&b"], "job": ["--requeue"]}}}})"));
    if (form == "shell")
        all.back().engines.clear();  // hivectl start does not support Slurm
    return all;
}

/// In a folder of its own; returns the paths.
std::vector<fs::path> written(const Swarm& swarm, const SwarmPlan& plan, const std::string& form)
{
    const auto programs = swarm.program("hivectl").parent_path().string();
    std::vector<fs::path> paths;
    const bool metrics = form == "compose" || form == "kubernetes";
    for (const auto& file : export_swarm(plan, form, {.programs = programs, .metrics = metrics})) {
        paths.push_back(swarm.home() / form / plan.name / file.name);
        fs::create_directories(paths.back().parent_path());
        std::ofstream(paths.back()) << file.text;
    }
    return paths;
}

using Paths = std::vector<fs::path>;

/// The validator, if installed, must accept the files of all plans.
/// @param command  the validator; gets the paths of each plan
void check_form(const std::string& form, const std::string& validator,
                const std::function<std::string(const std::vector<Paths>&)>& command)
{
    const Swarm swarm;
    if (!possible(swarm.run({"/bin/bash", "-c", "command -v " + validator}).exit_code == 0 ? "" : validator))
        return;
    std::vector<Paths> paths;
    for (const auto& plan : plans(form))
        paths.push_back(written(swarm, plan, form));
    const auto checked = swarm.run({"/bin/bash", "-c", "set -e\n" + command(paths)}, patient(30'000ms));
    CHECK_MESSAGE(checked.exit_code == 0, checked.out, checked.err);
    CHECK_EQ(checked.err, "");
}

std::string all_of(const std::vector<fs::path>& paths)
{
    std::string words;
    for (const auto& path : paths)
        words += " " + path.string();
    return words;
}

}  // namespace

TEST_CASE("swarm exports: systemd takes the units")
{
    check_form("systemd", "systemd-analyze", [](const std::vector<Paths>& plans_paths) {
        // One machine after the other: all targets have the same name.
        std::map<fs::path, Paths> machines;
        for (const auto& paths : plans_paths)
            for (const auto& path : paths)
                machines[path.parent_path()].push_back(path);
        std::string command = "export XDG_RUNTIME_DIR=$HIVE_HOME SYSTEMD_LOG_LEVEL=warning\n";
        for (const auto& [folder, units] : machines)
            command += "systemd-analyze --user --man=no verify" + all_of(units) + "\n";
        // And the installed unit, whose program is not yet at its final path.
        const std::string unit = "hive-metrics.service", installed = HIVE_SOURCE_DIR "/hivectl/monitoring/" + unit;
        return command + "sed \"s#=hivectl#=$(command -v hivectl)#\" " + installed + " > $HIVE_HOME/" + unit
               + "\nsystemd-analyze --user --man=no verify $HIVE_HOME/" + unit + "\n";
    });
}

TEST_CASE("swarm exports: compose takes the files")
{
    check_form("compose", "docker-compose", [](const std::vector<Paths>& plans_paths) {
        // It takes a second to start, so one process gets all; it checks each before merging them.
        std::string files;
        for (const auto& paths : plans_paths)
            files += " -f " + paths[0].string();
        const auto folder = plans_paths[0][0].parent_path().string();
        return "touch " + folder + "/swarm.key\ndocker-compose" + files + " config -q\n";
    });
}

TEST_CASE("swarm exports: kubectl takes the manifests")
{
    check_form("kubernetes", "kubectl", [](const std::vector<Paths>& plans_paths) {
        std::string command;
        for (const auto& paths : plans_paths) {
            const auto folder = paths[0].parent_path().string();
            // A new key is a Secret of another name, which each pod mounts.
            command += "cd " + folder
                       + "\nfor key in 1 2; do echo $key > swarm.key; kubectl kustomize . > $key; done\n"
                         "name() { grep -o '[a-z-]*-key-[a-z0-9]*$' $1 | sort -u; }\n"
                         "[ $(name 1 | wc -l) = 1 ]; [ $(name 2 | wc -l) = 1 ]; [ $(name 1) != $(name 2) ]\n"
                         "[ $(grep -c secretName: 1) = $(grep -c \"secretName: $(name 1)$\" 1) ]\n";
        }
        return command;
    });
}

TEST_CASE("swarm exports: bash takes the scripts")
{
    for (const std::string form : {"slurm", "shell"})
        check_form(form, "bash", [](const std::vector<Paths>& plans_paths) {
            std::string command;
            for (const auto& paths : plans_paths)
                command += "bash -n " + paths[0].string() + "\n";
            return command;
        });
}

TEST_CASE("swarm exports: the script of hivectl makes the swarm")
{
    const Swarm swarm;
    const auto script = swarm.home() / "face.sh";
    const auto plan = plan_of(text_of(HIVE_SOURCE_DIR "/scripts/swarms/face.json"));
    std::ofstream(script) << export_swarm(plan, "shell").at(0).text;
    const auto done = swarm.run({"/bin/bash", script.string()}, patient(30'000ms));
    CHECK_MESSAGE(done.exit_code == 0, done.err);
    auto application = swarm.application();
    CHECK(application.collect({{"face", "faces"}})->next(patient(15'000ms)));
}
