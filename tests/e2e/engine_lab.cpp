// Creates machines with the files of an export form: /etc and /run of each, plus these files.
#include "engine_lab.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <stdexcept>

namespace hive::test {
namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr auto camera_address = "192.0.2.10";  // as in scripts/swarms/axis.json

/// Files of an engine are in `root` of the home.
constexpr auto with_files = R"(for top in "$0"/root/*; do
    [ ! -d "$top" ] || mount -t overlay overlay -o "lowerdir=$top:/${top##*/}" "/${top##*/}" || exit 125
done
exec "$@")";

std::string name_in(const std::vector<std::string>& words)
{
    const auto option =
        std::ranges::find_if(words, [](const auto& word) { return word == "--name" || word == "--as"; });
    return option == words.end() ? "" : *std::next(option);
}

void write_file(const fs::path& path, const std::string& text)
{
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text;
    fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
}

}  // namespace

std::string missing_for_engines()
{
    auto missing = missing_for_lab();
    if (missing.empty() && Swarm().run({"/usr/bin/python3", "-c", "import yaml"}).exit_code != 0)
        missing = "python3-yaml";
    return missing;
}

EngineLab::EngineLab(std::string form, const fs::path& swarm_file)
    : form_(std::move(form)), hub_(swarm_, "hv-" + std::to_string(::getpid()) + "-engines")
{
    hub_.run(std::string("ip link set lo up; ip address add ") + camera_address
             + "/32 dev lo; echo 1 > /proc/sys/net/ipv4/ip_forward");
    const auto folder = swarm_.home() / "written";
    swarm_.hivectl_done(
        {"export", "--from", swarm_file.string(), "--as", form_, "--to", folder.string(), "--timeout", "60"}, 90'000ms);
    const auto read_there = swarm_.run(
        {"/usr/bin/python3", HIVE_SOURCE_DIR "/tests/e2e/engine_stand_in.py", form_, folder.string()}, 30'000ms);
    if (read_there.exit_code != 0)
        throw std::runtime_error("what was written as " + form_ + " cannot be read: " + read_there.err);
    add_machines(Json::parse(read_there.out));
    if (text_of(swarm_file).find(camera_address) != std::string::npos)
        camera_.emplace(hub_.inside({"/usr/bin/python3", HIVE_SOURCE_DIR "/tests/support/axis_camera.py",
                                     "address=0.0.0.0", "port=80", "control=81"}),
                        std::vector<std::string>{}, swarm_.home() / "camera.log");
}

EngineLab::~EngineLab()
{
    if (form_ == "shell")
        static_cast<void>(shell("hivectl stop --all --timeout 30"));
}

void EngineLab::add_machines(const Json& runs)
{
    const auto& here = *machines_.emplace_back(std::make_unique<Machine>(hub_, "here", 1));
    fs::create_directory(here.swarm.home() / ".config");
    here.swarm.hivectl_done({"key", "new"});
    std::string hosts = "127.0.0.1 localhost\n";
    for (const auto& read : runs) {
        const auto name = name_in(read.at("words"));
        auto& run = runs_[names_.emplace_back(name)];
        run = {read.at("words"), read.at("probe"), {}, read.at("host"), &here, {}};
        for (const auto& [key, value] : read.at("variables").items())
            run.variables.push_back(key + "=" + value.get<std::string>());
        if (read.contains("then"))
            then_ = read.at("then");
        if (run.host.empty())
            continue;
        const auto number = static_cast<int>(machines_.size()) + 1;
        run.machine = machines_.emplace_back(std::make_unique<Machine>(hub_, run.host, number)).get();
        hosts += run.machine->address + " " + run.host + "\n";
        for (const auto& [path, source] : read.at("files").items())
            write_file(run.machine->swarm.home() / "root" / path.substr(1), text_of(here.swarm.key_file()));
    }
    if (machines_.size() == 1)
        return;
    for (const auto& machine : machines_)
        write_file(machine->swarm.home() / "root/etc/hosts", hosts);
}

std::vector<std::string> EngineLab::inside(const Machine& machine, const std::vector<std::string>& variables,
                                           const std::vector<std::string>& words) const
{
    const auto top = machine.swarm.home().string(), home = top + "/" + std::to_string(boots_);
    if (fs::create_directory(home))
        fs::permissions(home, fs::perms::owner_all);
    std::vector<std::string> all{"/bin/sh",
                                 "-c",
                                 with_files,
                                 top,
                                 "/usr/bin/env",
                                 "-i",
                                 "HIVE_HOME=" + home,
                                 "PATH=" + swarm_.program("").string() + ":/usr/bin:/bin",
                                 "DBUS_SYSTEM_BUS_ADDRESS=unix:path=" + top + "/bus"};
    all.insert(all.end(), variables.begin(), variables.end());
    all.insert(all.end(), words.begin(), words.end());
    return machine.net.inside(all);
}

void EngineLab::start(const std::string& drone)
{
    auto& run = runs_.at(drone);
    const auto words = inside(*run.machine, run.variables, run.words);
    run.process.emplace(words, std::vector<std::string>{}, swarm_.home() / "drones.log");
    if (form_ == "shell" && run.process->wait(patient(60'000ms)) != 0)
        throw std::runtime_error(drone + " does not start:\n" + text_of(swarm_.home() / "drones.log"));
}

void EngineLab::finish() const
{
    for (const auto& [name, run] : runs_)
        if (!run.host.empty()
            && !eventually([&, line = "hivectl place add " + name + " tcp://" + run.host
                                      + ":7700"] { return shell(line).exit_code == 0; },
                           60'000ms))
            throw std::runtime_error(name + " does not come up:\n" + text_of(swarm_.home() / "drones.log"));
    for (const auto& words : then_)
        if (const auto done = swarm_.run(inside(*machines_[0], {}, words), 60'000ms); done.exit_code != 0)
            throw std::runtime_error(done.err);
}

void EngineLab::kill(const std::string& drone)
{
    if (form_ != "shell")
        return runs_.at(drone).process->kill();
    const auto pid = [&]() -> pid_t {
        for (const auto& row : Json::parse(shell_done("hivectl ps --json --timeout 10")))
            if (row.at("name") == drone && row.at("pid").is_number())
                return row.at("pid").get<pid_t>();
        return 0;
    };
    const auto killed = pid();
    if (killed <= 1 || ::kill(killed, SIGKILL) != 0 || !eventually([&] { return pid() != killed; }, 60'000ms))
        throw std::runtime_error(drone + " cannot be killed");
}

void EngineLab::reboot()
{
    for (const auto& [name, run] : runs_)
        if (run.process)
            kill(name);
    ++boots_;
}

bool EngineLab::is_well(const std::string& drone) const
{
    const auto& run = runs_.at(drone);
    if (run.probe.empty())
        return shell("hivectl wait " + drone + " --timeout 5").exit_code == 0;
    return beside(drone, run.probe).exit_code == 0;
}

Finished EngineLab::beside(const std::string& drone, const std::vector<std::string>& words) const
{
    const auto& run = runs_.at(drone);
    return swarm_.run(inside(*run.machine, run.variables, words), 60'000ms);
}

Finished EngineLab::shell(const std::string& line) const
{
    const auto& here = *machines_[0];
    const auto config = "XDG_CONFIG_HOME=" + (here.swarm.home() / "config").string();
    return swarm_.run(inside(here, {config}, {"/bin/sh", "-c", line}), 90'000ms);
}

std::string EngineLab::shell_done(const std::string& line) const
{
    auto done = shell(line);
    if (done.exit_code != 0)
        throw std::runtime_error(line + " exited with " + std::to_string(done.exit_code) + "\n" + done.out + done.err
                                 + text_of(swarm_.home() / "drones.log"));
    return std::move(done.out);
}

}  // namespace hive::test
