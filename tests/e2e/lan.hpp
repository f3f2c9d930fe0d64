// Machines on one local network, each with its own system bus and Avahi daemon. Needs root, iproute2, dbus and
// avahi-daemon.
#pragma once

#include "lab.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hive::test {

class Neighbour {
public:
    /// @param number  of its address, 10.79.0.NUMBER
    Neighbour(const Namespace& lan, const std::string& name, int number);

    [[nodiscard]] const std::string& address() const { return address_; }
    [[nodiscard]] const Swarm& swarm() const { return swarm_; }
    /// Runs a program on it; hivectl in its own home, or in that of another swarm.
    [[nodiscard]] Finished run(const std::vector<std::string>& words) const { return run_in(swarm_, words); }
    [[nodiscard]] Finished run_in(const Swarm& home, const std::vector<std::string>& words) const;
    /// Runs hivectl, which must succeed. @return its output
    std::string hivectl(const std::vector<std::string>& words) const { return hivectl_in(swarm_, words); }
    std::string hivectl_in(const Swarm& home, std::vector<std::string> words) const;
    void start_daemon();
    /// Runs hivectl in the background; its output goes to NAME.log in the home.
    [[nodiscard]] Process hivectl_running(std::vector<std::string> words, const std::string& name) const;
    /// Returns when it answers; announcements of others may arrive later.
    void await_daemon() const;
    void kill_daemon() { daemon_.reset(); }
    /// SIGSTOP, SIGCONT.
    void signal_daemon(int number) const { daemon_.value().signal(number); }
    void signal_bus(int number) const { bus_.value().signal(number); }
    /// Disconnects it from the network without notifying the others.
    void cut() const { net_.run("ip link set lan down"); }
    /// Additional announcements of the daemon: files of /etc/avahi/services. Before start_daemon().
    [[nodiscard]] std::filesystem::path services() const { return swarm_.home() / "services"; }

private:
    [[nodiscard]] std::vector<std::string> with_bus(const std::vector<std::string>& words) const;
    [[nodiscard]] std::string bus() const { return "unix:path=" + (swarm_.home() / "bus").string(); }

    [[nodiscard]] std::filesystem::path daemon_log() const { return swarm_.home() / "avahi.log"; }

    Swarm swarm_;
    std::string address_;
    Namespace net_;
    std::optional<Process> bus_, daemon_;
};

/// What this machine lacks, or nothing.
std::string missing_for_lan();

class Lan {
public:
    explicit Lan(const std::vector<std::string>& names);

    [[nodiscard]] Neighbour& operator[](std::size_t index) const { return *machines_.at(index); }
    /// Copies the key of the first machine, created if missing, to another home.
    void share_key(const Swarm& to) const;

private:
    Swarm swarm_;
    Namespace switch_;
    std::vector<std::unique_ptr<Neighbour>> machines_;
};

}  // namespace hive::test
