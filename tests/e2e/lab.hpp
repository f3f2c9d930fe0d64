// A laptop and machines that it reaches over ssh, as network namespaces with an sshd each. Needs root, iproute2 and
// openssh-server.
#pragma once

#include "swarm.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hive::test {

using Seconds = std::chrono::duration<double>;

/// A network namespace, removed at the end.
class Namespace {
public:
    Namespace(const Swarm& swarm, std::string name);
    ~Namespace();
    Namespace(const Namespace&) = delete;
    Namespace& operator=(const Namespace&) = delete;

    [[nodiscard]] bool made() const { return made_; }
    [[nodiscard]] const std::string& name() const { return name_; }
    /// The command that runs a command inside.
    [[nodiscard]] std::vector<std::string> inside(const std::vector<std::string>& words) const;
    void run(const std::string& commands) const;

private:
    const Swarm& swarm_;
    std::string name_;
    bool made_ = false;
};

/// A machine with its own home and an address reachable by the others.
struct Machine {
    Machine(const Namespace& hub, const std::string& name, int number);
    /// Runs hivectl on it, which must succeed; started drones keep running.
    void hivectl_done(const std::string& words) const { net.run(swarm.program("hivectl").string() + " " + words); }

    Swarm swarm;
    Namespace net;
    std::string address;
};

/// What this machine lacks, or nothing.
std::string missing_for_lab();

class Lab {
public:
    /// @param variables  "NAME=value" for commands on the machines over ssh
    explicit Lab(const std::vector<std::string>& names, const std::vector<std::string>& variables = {});

    /// Runs a shell command on the laptop, with hivectl, ssh and scp in its path and an empty home.
    [[nodiscard]] Finished shell(const std::string& line, Milliseconds timeout = Milliseconds(60'000)) const;
    std::string shell_done(const std::string& line) const;
    std::string hivectl_done(const std::string& words) const { return shell_done("hivectl " + words); }
    /// Runs hivectl on the laptop in the background; its output goes to NAME.log in directory().
    [[nodiscard]] Process hivectl_running(const std::string& words, const std::string& name) const;
    /// Creates a key and copies it to all.
    void share_key() const;
    /// Disconnects a machine from the network, and reconnects it.
    void cut(std::size_t machine) const { hub_.run("ip link set " + link_of(machine) + " down"); }
    void mend(std::size_t machine) const { hub_.run("ip link set " + link_of(machine) + " up"); }
    /// Drops packets from one machine to another silently, and ends that.
    void swallow(std::size_t from, std::size_t to) const { hub_.run("ip rule add " + way(from, to)); }
    void let_through(std::size_t from, std::size_t to) const { hub_.run("ip rule delete " + way(from, to)); }
    [[nodiscard]] const Swarm& laptop() const { return laptop_->swarm; }
    [[nodiscard]] const std::string& laptop_network() const { return laptop_->net.name(); }
    /// The central namespace, to which all are linked.
    [[nodiscard]] const std::string& hub() const { return hub_.name(); }
    [[nodiscard]] const Machine& machine(std::size_t index) const { return *machines_.at(index); }
    [[nodiscard]] std::filesystem::path directory() const { return laptop_home_.home(); }

private:
    static std::string link_of(std::size_t machine) { return "h" + std::to_string(machine + 2); }
    [[nodiscard]] std::string way(std::size_t from, std::size_t to) const;
    [[nodiscard]] std::vector<std::string> on_laptop(const std::string& line) const;
    void run(const std::string& commands) const;
    void add(const std::string& name, const std::vector<std::string>& variables);
    void write_ssh() const;

    Swarm laptop_home_;
    Namespace hub_;
    std::unique_ptr<Machine> laptop_;
    std::vector<std::unique_ptr<Machine>> machines_;
    std::vector<Process> sshd_;
    std::vector<std::string> names_;
    std::string config_, known_;
};

}  // namespace hive::test
