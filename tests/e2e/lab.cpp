// Creates namespaces, links, and an ssh configuration without the real user's files.
#include "lab.hpp"

#include <fstream>
#include <stdexcept>
#include <unistd.h>

namespace hive::test {
namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

void require_done(const Finished& done, const std::string& what)
{
    if (done.exit_code != 0)
        throw std::runtime_error(what + " exited with " + std::to_string(done.exit_code) + "\n" + done.out + done.err);
}

/// Its programs search for the key at the user's default path.
void make_home(const Swarm& swarm) { fs::create_directory_symlink(".config", swarm.home() / "config"); }

}  // namespace

Namespace::Namespace(const Swarm& swarm, std::string name) : swarm_(swarm), name_(std::move(name))
{
    made_ = swarm_.run({"/usr/bin/env", "ip", "netns", "add", name_}).exit_code == 0;
}

/// Kills the processes inside, too: a session of sshd would wait for the other end of its connection.
Namespace::~Namespace()
{
    if (made_)
        static_cast<void>(swarm_.run(
            {"/bin/sh", "-c",
             "for pid in $(ip netns pids " + name_ + "); do kill -KILL $pid; done; " + "ip netns delete " + name_}));
}

std::vector<std::string> Namespace::inside(const std::vector<std::string>& words) const
{
    std::vector<std::string> all{"/usr/bin/env", "ip", "netns", "exec", name_};
    all.insert(all.end(), words.begin(), words.end());
    return all;
}

void Namespace::run(const std::string& commands) const
{
    require_done(swarm_.run(inside({"/bin/sh", "-ec", commands})), commands);
}

Machine::Machine(const Namespace& hub, const std::string& name, int number)
    : net(swarm, hub.name() + "-" + name), address("10.77." + std::to_string(number) + ".2")
{
    make_home(swarm);
    const std::string link = "h" + std::to_string(number), ends = "10.77." + std::to_string(number);
    hub.run("ip link add " + link + " type veth peer name uplink netns " + net.name() + "; ip address add " + ends
            + ".1/24 dev " + link + "; ip link set " + link + " up");
    net.run("ip link set lo up; ip address add " + address + "/24 dev uplink; ip link set uplink up; ip route add "
            + "default via " + ends + ".1");
}

std::string missing_for_lab()
{
    if (::getuid() != 0)
        return "root";
    if (!fs::exists("/usr/sbin/sshd") || !fs::exists("/usr/lib/openssh/sftp-server"))
        return "openssh-server";
    const Swarm swarm;
    const Namespace trial(swarm, "hv-try-" + std::to_string(::getpid()));
    const std::string links = "ip link add h1 type veth peer name h2 && echo 1 > /proc/sys/net/ipv4/ip_forward";
    const bool possible = trial.made() && swarm.run(trial.inside({"/bin/sh", "-c", links})).exit_code == 0;
    return possible ? "" : "iproute2, and the right to make network namespaces that forward packets";
}

Lab::Lab(const std::vector<std::string>& names, const std::vector<std::string>& variables)
    : hub_(laptop_home_, "hv-" + std::to_string(::getpid())), names_(names)
{
    hub_.run("ip link set lo up; echo 1 > /proc/sys/net/ipv4/ip_forward");
    laptop_ = std::make_unique<Machine>(hub_, "laptop", 1);
    run("mkdir -p keys bin /run/sshd; for k in host user; do ssh-keygen -q -t ed25519 -N '' -f keys/$k; done");
    for (const auto& name : names)
        add(name, variables);
    write_ssh();
}

Finished Lab::shell(const std::string& line, Milliseconds timeout) const
{
    return laptop_->swarm.run(on_laptop(line), timeout);
}

std::string Lab::shell_done(const std::string& line) const
{
    auto done = shell(line);
    require_done(done, line);
    return std::move(done.out);
}

Process Lab::hivectl_running(const std::string& words, const std::string& name) const
{
    return {on_laptop("exec hivectl " + words),
            {"HIVE_HOME=" + laptop_->swarm.home().string()},
            directory() / (name + ".log")};
}

void Lab::share_key() const
{
    hivectl_done("key new");
    for (const auto& name : names_)
        shell_done("ssh " + name + " mkdir -p .config/hive && scp ~/.config/hive/swarm.key " + name
                   + ":.config/hive/swarm.key");
}

std::string Lab::way(std::size_t from, std::size_t to) const
{
    return "from " + machine(from).address + " to " + machine(to).address + " blackhole";
}

std::vector<std::string> Lab::on_laptop(const std::string& line) const
{
    const auto path = (directory() / "bin").string() + ":" + laptop_->swarm.program("hivectl").parent_path().string();
    return laptop_->net.inside(
        {"/bin/sh", "-c",
         "unset XDG_CONFIG_HOME HIVE_KEY; export HOME=" + directory().string() + " PATH=" + path + ":$PATH; " + line});
}

void Lab::run(const std::string& commands) const
{
    require_done(laptop_home_.run({"/bin/sh", "-ec", "cd " + directory().string() + "; " + commands}), commands);
}

/// Its sshd starts all sessions in the machine's own home, also for scp.
void Lab::add(const std::string& name, const std::vector<std::string>& variables)
{
    const auto number = static_cast<int>(machines_.size()) + 2;
    const auto& machine = *machines_.emplace_back(std::make_unique<Machine>(hub_, name, number));
    const auto file = (directory() / (name + ".conf")).string(), here = directory().string();
    const auto home = machine.swarm.home().string();
    std::ofstream config(file);
    config << "HostKey " << here << "/keys/host\nAuthorizedKeysFile " << here
           << "/keys/user.pub\nStrictModes no\nPermitRootLogin yes\nUsePAM no\nPidFile none\n"
              "Subsystem sftp /usr/lib/openssh/sftp-server\n"
              "ForceCommand cd \"$HOME\" && exec /bin/sh -c \"$SSH_ORIGINAL_COMMAND\"\nSetEnv HOME="
           << home << " HIVE_HOME=" << home << " DBUS_SYSTEM_BUS_ADDRESS=unix:path=" << home
           << "/bus PATH=" << machine.swarm.program("hivectl").parent_path().string() << ":/usr/bin:/bin";
    for (const auto& variable : variables)
        config << " " << variable;
    config << std::endl;
    sshd_.emplace_back(machine.net.inside({"/usr/sbin/sshd", "-D", "-e", "-f", file}), std::vector<std::string>{},
                       directory() / (name + ".sshd.log"));
    config_ += "Host " + name + "\n  HostName " + machine.address + "\n";
    known_ += machine.address + " " + text_of(directory() / "keys/host.pub");
}

void Lab::write_ssh() const
{
    const auto here = directory().string();
    std::ofstream(directory() / "known") << known_;
    std::ofstream(directory() / "ssh_config") << config_ << "Host *\n  User root\n  IdentityFile " << here
                                              << "/keys/user\n  IdentitiesOnly yes\n  UserKnownHostsFile " << here
                                              << "/known\n  StrictHostKeyChecking yes\n  ConnectionAttempts 3\n";
    for (const std::string program : {"ssh", "scp"}) {
        const auto file = directory() / "bin" / program;
        std::ofstream(file) << "#!/bin/sh\nexec /usr/bin/" << program << " -F " << here << "/ssh_config \"$@\"\n";
        fs::permissions(file, fs::perms::owner_all);
    }
}

}  // namespace hive::test
