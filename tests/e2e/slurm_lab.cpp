// The settings with which Slurm runs without systemd, cgroups and a second machine.
#include "slurm_lab.hpp"

#include "free_port.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <unistd.h>

namespace hive::test {
namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

const std::vector<std::string> nodes{"n1", "n2", "n3"};

std::string home_of(const std::string& node, const std::string& job) { return "/tmp/hive-0-" + job + "-" + node; }

std::string word_of(const std::string& text) { return text.substr(0, text.find_first_of(" ;\n")); }

}  // namespace

std::string missing_for_slurm()
{
    if (::getuid() != 0)
        return "root";
    for (const char* program : {"/usr/sbin/slurmctld", "/usr/sbin/slurmd", "/usr/sbin/munged", "/usr/bin/srun"})
        if (!fs::exists(program))
            return program;
    return {};
}

SlurmLab::SlurmLab() : directory_(swarm_.home() / "slurm")
{
    configure();
    const auto start = [&](const std::vector<std::string>& words, const std::string& log) {
        daemons_.emplace_back(words, variables(), directory_ / (log + ".out"));
    };
    const auto munge = (directory_ / "munge").string();
    start({"/usr/sbin/munged", "-F", "--force", "--key-file=" + munge + ".key", "--socket=" + munge + ".socket",
           "--pid-file=" + munge + ".pid", "--log-file=" + munge + ".log", "--seed-file=" + munge + ".seed"},
          "munged");
    if (!eventually([&] { return fs::exists(munge + ".socket"); }, 10'000ms))
        throw std::runtime_error("munged does not start: " + text_of(directory_ / "munged.out"));
    start({"/usr/sbin/slurmctld", "-D"}, "slurmctld");
    for (const auto& node : nodes)
        start({"/usr/sbin/slurmd", "-D", "-N", node}, node);
    const bool granted = eventually(
        [&] {
            return slurm({"salloc", "-N3", "--no-shell", "--immediate=5"}).exit_code == 0;
        },
        30'000ms);
    job_ = word_of(slurm({"squeue", "--noheader", "--format=%i"}).out);
    if (!granted || job_.empty())
        throw std::runtime_error("Slurm gives no allocation: " + text_of(directory_ / "slurmctld.out"));
}

SlurmLab::~SlurmLab() { end_job(); }

void SlurmLab::end_job() const
{
    static_cast<void>(slurm({"scancel", job_}));
    eventually([&] { return processes() == 0 && slurm({"squeue", "--noheader"}).out.empty(); }, 20'000ms);
    std::error_code ignored;
    std::istringstream jobs(slurm({"scontrol", "--oneliner", "show", "jobs"}).out);
    for (std::string line; std::getline(jobs, line);)
        for (const auto& node : nodes)
            fs::remove_all(home_of(node, word_of(line.substr(std::string("JobId=").size()))), ignored);
}

void SlurmLab::submit(const fs::path& script)
{
    end_job();
    const auto submitted = slurm({"/usr/bin/env", "--unset=HIVE_HOME", "sbatch", "--parsable",
                                  "--output=" + (swarm_.home() / "sbatch.log").string(), script.string()});
    if (submitted.exit_code != 0)
        throw std::runtime_error("sbatch refuses " + script.string() + ": " + submitted.err);
    job_ = word_of(submitted.out);
}

void SlurmLab::configure() const
{
    const auto here = directory_.string();
    fs::create_directories(directory_ / "state");
    std::ofstream(directory_ / "munge.key") << std::string(1024, 'k');
    fs::permissions(directory_ / "munge.key", fs::perms::owner_read | fs::perms::owner_write);
    std::ofstream config(directory_ / "slurm.conf");
    config << "ClusterName=lab\nSlurmctldHost=localhost\nSlurmctldPort=" << free_port()
           << "\nSlurmUser=root\nSlurmdUser=root\nAuthType=auth/munge\nAuthInfo=socket=" << here
           << "/munge.socket\nSlurmctldPidFile=" << here << "/slurmctld.pid\nSlurmdPidFile=" << here
           << "/%n.pid\nStateSaveLocation=" << here << "/state\nSlurmdSpoolDir=" << here
           << "/spool-%n\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSelectType=select/cons_tres\n"
              "SelectTypeParameters=CR_CPU\nJobAcctGatherType=jobacct_gather/none\n"
              "AccountingStorageType=accounting_storage/none\nMpiDefault=none\nSwitchType=switch/none\n"
              "GresTypes=gpu\nReturnToService=2\nSlurmdParameters=config_overrides\nKillWait=2\nFirstJobId="
           << ::getpid() << "\n";  // unique per lab: homes are named after it
    for (const auto& node : nodes)
        config << "NodeName=" << node
               << " NodeHostname=localhost NodeAddr=127.0.0.1 CPUs=16 Gres=gpu:2 Port=" << free_port() << "\n";
    std::ofstream(directory_ / "gres.conf")
        << "Name=gpu File=/dev/null\nName=gpu File=/dev/zero\n";  // Slurm wants files
    config << "PartitionName=lab Nodes=n1,n2,n3 Default=YES MaxTime=INFINITE State=UP\n";
}

std::vector<std::string> SlurmLab::variables() const { return {"SLURM_CONF=" + (directory_ / "slurm.conf").string()}; }

Finished SlurmLab::slurm(const std::vector<std::string>& words) const
{
    std::vector<std::string> all{"/usr/bin/env", variables().at(0)};
    all.insert(all.end(), words.begin(), words.end());
    return swarm_.run(all, 20'000ms);
}

Finished SlurmLab::shell(const std::string& line) const
{
    return swarm_.run({"/usr/bin/env", variables().at(0), "SLURM_JOB_ID=" + job_, "/bin/sh", "-c", line}, 60'000ms);
}

std::string SlurmLab::shell_done(const std::string& line) const
{
    auto done = shell(line);
    if (done.exit_code != 0)
        throw std::runtime_error(line + " exited with " + std::to_string(done.exit_code) + "\n" + done.out + done.err);
    return std::move(done.out);
}

Process SlurmLab::hivectl_running(const std::vector<std::string>& words, const std::string& name) const
{
    std::vector<std::string> all{"/usr/bin/env", "SLURM_JOB_ID=" + job_, swarm_.program("hivectl").string()};
    all.insert(all.end(), words.begin(), words.end());
    auto environment = variables();
    environment.insert(environment.end(), {"HIVE_HOME=" + swarm_.home().string(),
                                           "XDG_CONFIG_HOME=" + (swarm_.home() / "config").string(), "HIVE_KEY="});
    return {all, environment, swarm_.home() / (name + ".log")};
}

std::vector<std::string> SlurmLab::steps() const
{
    std::istringstream lines(slurm({"squeue", "--steps", "--noheader", "--format=%j"}).out);
    std::vector<std::string> names;
    for (std::string name; lines >> name;)
        if (name != "extern" && name != "batch")
            names.push_back(name);
    std::ranges::sort(names);
    return names;
}

std::size_t SlurmLab::processes(const std::string& node) const
{
    std::size_t count = 0;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator("/proc", ignored)) {
        const auto command = text_of(entry.path() / "cmdline"), environment = text_of(entry.path() / "environ") + '\0';
        if (command.substr(0, command.find('\0')).find("/hive-") == std::string::npos)
            continue;
        for (const auto& one : nodes)
            if ((node.empty() || one == node)
                && environment.find("HIVE_HOME=" + home_of(one, job_) + '\0') != std::string::npos)
                ++count;
    }
    return count;
}

}  // namespace hive::test
