// A bridge with namespaces, each with the two daemons.
#include "lan.hpp"

#include <fstream>
#include <stdexcept>
#include <unistd.h>

namespace hive::test {
namespace fs = std::filesystem;

namespace {

constexpr const char* bus_config =
    R"(<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig><type>system</type><auth>EXTERNAL</auth><policy context="default"><allow user="*"/><allow own="*"/>
<allow send_type="method_call"/><allow send_type="signal"/><allow send_requested_reply="true"/>
<allow receive_type="method_call"/><allow receive_type="signal"/><allow receive_type="method_return"/>
<allow receive_type="error"/></policy>)";

constexpr const char* daemon_program = "/usr/sbin/avahi-daemon";
constexpr const char* daemon_options = " --no-drop-root --no-chroot --no-rlimits --no-proc-title";

}  // namespace

Neighbour::Neighbour(const Namespace& lan, const std::string& name, int number)
    : address_("10.79.0." + std::to_string(number)), net_(swarm_, lan.name() + "-" + name)
{
    const std::string link = "l" + std::to_string(number);
    lan.run("ip link add " + link + " type veth peer name lan netns " + net_.name() + "; ip link set " + link
            + " master br0; ip link set " + link + " up");
    net_.run("ip link set lo up; ip address add " + address_ + "/24 dev lan; ip link set lan up");
    fs::create_directory(services());
    std::ofstream(swarm_.home() / "bus.conf") << bus_config << "<listen>" << bus() << "</listen></busconfig>\n";
    std::ofstream(swarm_.home() / "avahi.conf")
        << "[server]\nhost-name=" << name << "\nuse-ipv4=yes\nuse-ipv6=yes\n[wide-area]\nenable-wide-area=no\n";
    bus_.emplace(net_.inside({"/usr/bin/env", "dbus-daemon", "--nofork", "--nopidfile",
                              "--config-file=" + (swarm_.home() / "bus.conf").string()}),
                 std::vector<std::string>{}, swarm_.home() / "bus.log");
    if (!eventually([&] { return fs::exists(swarm_.home() / "bus"); }))
        throw std::runtime_error("dbus-daemon does not start\n" + text_of(swarm_.home() / "bus.log"));
}

/// It has its own /run and /etc/avahi/services: `ip netns exec` creates separate mounts.
void Neighbour::start_daemon()
{
    fs::remove(daemon_log());
    const std::string start = "mount -t tmpfs none /run; mount --bind " + services().string()
                              + " /etc/avahi/services; exec " + daemon_program + " -f "
                              + (swarm_.home() / "avahi.conf").string() + daemon_options;
    daemon_.emplace(net_.inside(with_bus({"/bin/sh", "-ec", start})), std::vector<std::string>{}, daemon_log());
}

void Neighbour::await_daemon() const
{
    const auto answers = [&] { return text_of(daemon_log()).find("Server startup complete") != std::string::npos; };
    if (!eventually(answers, Milliseconds(10'000)))
        throw std::runtime_error("avahi-daemon does not start\n" + text_of(daemon_log()));
}

std::vector<std::string> Neighbour::with_bus(const std::vector<std::string>& words) const
{
    std::vector<std::string> all{"/usr/bin/env", "DBUS_SYSTEM_BUS_ADDRESS=" + bus()};
    all.insert(all.end(), words.begin(), words.end());
    return all;
}

Finished Neighbour::run_in(const Swarm& home, const std::vector<std::string>& words) const
{
    return home.run(net_.inside(with_bus(words)));
}

std::string Neighbour::hivectl_in(const Swarm& home, std::vector<std::string> words) const
{
    words.insert(words.begin(), swarm_.program("hivectl").string());
    auto done = run_in(home, words);
    if (done.exit_code != 0)
        throw std::runtime_error("hivectl " + words.at(1) + " exited with " + std::to_string(done.exit_code) + "\n"
                                 + done.out + done.err);
    return std::move(done.out);
}

Process Neighbour::hivectl_running(std::vector<std::string> words, const std::string& name) const
{
    words.insert(words.begin(), swarm_.program("hivectl").string());
    return {net_.inside(with_bus(words)),
            {"HIVE_HOME=" + swarm_.home().string(), "HIVE_KEY=" + swarm_.key_file().string()},
            swarm_.home() / (name + ".log")};
}

std::string missing_for_lan()
{
    if (::getuid() != 0)
        return "root";
    if (!fs::exists(daemon_program) || !fs::exists("/usr/bin/dbus-daemon"))
        return "avahi-daemon and dbus";
    const Swarm swarm;
    const Namespace trial(swarm, "hv-try-" + std::to_string(::getpid()));
    const std::string steps = "ip link add br0 type bridge && ip link add h1 type veth peer name h2 && "
                              "mount -t tmpfs none /run";
    const bool possible = trial.made() && swarm.run(trial.inside({"/bin/sh", "-c", steps})).exit_code == 0;
    return possible ? "" : "iproute2, and the right to make network namespaces with a bridge";
}

Lan::Lan(const std::vector<std::string>& names) : switch_(swarm_, "hl-" + std::to_string(::getpid()))
{
    switch_.run("ip link add br0 type bridge mcast_snooping 0; ip link set br0 up");
    for (const auto& name : names)
        machines_.push_back(std::make_unique<Neighbour>(switch_, name, static_cast<int>(machines_.size()) + 1));
}

void Lan::share_key(const Swarm& to) const
{
    const auto& first = machines_.front()->swarm();
    if (!fs::exists(first.key_file()))
        first.hivectl_done({"key", "new"});
    if (&to == &first)
        return;
    fs::create_directories(to.key_file().parent_path());
    fs::copy_file(first.key_file(), to.key_file());
    fs::permissions(to.key_file(), fs::perms::owner_read | fs::perms::owner_write);
}

}  // namespace hive::test
