// Drones of one host are on one machine; those of one process are counted once.
#include "machine_causes.hpp"

#include <hive/duration_text.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

namespace hive::explaining {
namespace {

using What = Cause::What;

constexpr double full = 0.95;      // of the processors' time
constexpr double short_of = 0.05;  // of the memory
constexpr std::size_t max_named = 3;

/// What a process uses.
struct User {
    std::string drone;
    double processors = 0, memory = 0;
};

struct Machine {
    std::string host{};
    MachineStatus status{};
    double busy = 0;                       ///< processors, between the looks
    std::map<std::int64_t, User> users{};  ///< by process
};

std::string tenths(double number)
{
    const auto rounded = std::llround(number * 10);
    return std::to_string(rounded / 10) + "." + std::to_string(rounded % 10);
}

std::string gigabytes(double bytes) { return tenths(bytes / 1e9) + " GB"; }

std::string machine_text(const std::string& host)
{
    return host.empty() || host == Place::here ? "this machine" : host;
}

/// @param same  do two statuses of one host share what is examined?
template <class Same>
std::vector<Machine> machines_of(const Look& first, const Look& second, const Same& same)
{
    std::vector<Machine> machines;
    for (const auto& answer : second.answers) {
        const auto* const found = first.find(answer.drone);
        const auto *const before = found ? value_of(found->status) : nullptr, *const now = value_of(answer.status);
        if (!before || !now || before->epoch != now->epoch || now->machine.processors == 0)
            continue;
        auto machine = std::ranges::find_if(machines, [&](const Machine& other) {
            return other.host == answer.place.host && same(other.status, now->machine);
        });
        if (machine == machines.end())
            machine = machines.insert(machine, Machine{.host = answer.place.host, .status = now->machine});
        const auto time = std::max<std::int64_t>(1, now->uptime_us - before->uptime_us);
        const auto share = [&](std::int64_t from, std::int64_t to) {
            return static_cast<double>(to - from) / static_cast<double>(time);
        };
        machine->busy = std::max(machine->busy, share(before->machine.cpu_us, now->machine.cpu_us));
        machine->users[now->pid] = {answer.drone, share(before->cpu_us, now->cpu_us), static_cast<double>(now->memory)};
    }
    return machines;
}

std::vector<User> most(const Machine& machine, double User::*use)
{
    std::vector<User> users;
    for (const auto& [pid, user] : machine.users)
        users.push_back(user);
    std::ranges::sort(users, std::greater(), use);
    users.resize(std::min(users.size(), max_named));
    return users;
}

Cause cause(What what, const User& greatest, const std::string& text)
{
    return {.what = what, .drone = greatest.drone, .text = text, .command = "hivectl top", .blocks = false};
}

void add_processors(std::vector<Cause>& causes, const Machine& machine)
{
    const auto count = static_cast<double>(machine.status.processors);
    if (machine.busy < full * count)
        return;
    const auto users = most(machine, &User::processors);
    auto& busy = causes.emplace_back(cause(What::load, users.front(),
                                           "the " + std::to_string(machine.status.processors) + " processors of "
                                               + machine_text(machine.host) + " are busy all the time"));
    double rest = std::min(machine.busy, count);
    constexpr double noticeable = 0.05;
    for (const auto& user : users)
        busy.evidence += user.processors < noticeable ? "" : user.drone + " uses " + tenths(user.processors) + ", ";
    for (const auto& [pid, user] : machine.users)
        rest -= user.processors;
    busy.evidence += "other programs " + tenths(std::max(0.0, rest));
    if (users.front().processors > std::max(rest, noticeable * count))  // without it, there is time for the others
        busy.command = "hivectl halt " + users.front().drone;
}

/// "this machine", or the group of the drone whose process the kernel kills at the limit.
std::string owner_text(const Machine& machine, const std::string& drone)
{
    return machine.status.memory_limited ? "the control group of " + drone + " on " + machine_text(machine.host)
                                         : machine_text(machine.host);
}

bool is_short(const MachineStatus& machine)
{
    return machine.memory > 0
           && static_cast<double>(machine.memory_available) <= short_of * static_cast<double>(machine.memory);
}

void add_memory(std::vector<Cause>& causes, const Machine& machine)
{
    if (!is_short(machine.status))
        return;
    const auto all = static_cast<double>(machine.status.memory);
    const auto available = static_cast<double>(machine.status.memory_available);
    const auto users = most(machine, &User::memory);
    const auto& greatest = users.front();
    auto& short_one = causes.emplace_back(cause(What::memory, greatest,
                                                owner_text(machine, greatest.drone) + " has " + gigabytes(available)
                                                    + " of its " + gigabytes(all) + " of memory left"));
    for (const auto& user : users)
        short_one.evidence += (short_one.evidence.empty() ? "" : ", ") + user.drone + " uses " + gigabytes(user.memory);
    if (greatest.memory > (all - available) / 2)  // without it there is memory; otherwise other programs have it
        short_one.command = "hivectl stop " + greatest.drone;
}

/// Receivers know by how much the clock of another machine differs from their own.
void add_clocks(std::vector<Cause>& causes, const Look& look)
{
    constexpr std::int64_t noticeable_us = 1'000'000;
    std::set<std::pair<std::string, std::string>> known;
    for (const auto& answer : look.answers)
        if (const auto* const status = value_of(answer.status))
            for (const auto& input : status->inputs) {
                const auto* const sender = look.find(parse_endpoint(input.from).drone);
                if (std::abs(input.clock_offset_us) < noticeable_us || !sender
                    || !known.emplace(sender->place.host, answer.place.host).second)
                    continue;
                auto& differs = causes.emplace_back(cause(What::clock, {answer.drone},
                                                          "the clock of " + machine_text(sender->place.host) + " is "
                                                              + duration_text(std::abs(input.clock_offset_us))
                                                              + (input.clock_offset_us > 0 ? " ahead of" : " behind")
                                                              + " that of " + machine_text(answer.place.host)));
                differs.evidence = "measured between " + sender->drone + " and " + answer.drone;
                differs.command =
                    (sender->place.ssh.empty() ? "" : "ssh " + sender->place.ssh + " ") + "timedatectl set-ntp true";
            }
}

}  // namespace

std::vector<Cause> machine_causes(const Look& first, const Look& second)
{
    std::vector<Cause> causes;
    const auto same_processors = [](const MachineStatus&, const MachineStatus&) { return true; };
    const auto same_memory = [](const MachineStatus& one, const MachineStatus& other) {
        return one.memory_limited == other.memory_limited && one.memory == other.memory
               && (!one.memory_limited || is_short(one) == is_short(other));  // not two groups with equal limits
    };
    for (const auto& machine : machines_of(first, second, same_processors))
        add_processors(causes, machine);
    for (const auto& machine : machines_of(first, second, same_memory))
        add_memory(causes, machine);
    add_clocks(causes, second);
    return causes;
}

std::vector<Cause> same_names(const Look& look)
{
    std::map<std::string, std::vector<const StatusAnswer*>> drones;
    const auto status_of = [](const auto* answer) -> const Status& { return std::get<Status>(answer->status); };
    for (const auto& answer : look.answers) {
        const auto* const status = value_of(answer.status);
        if (!status)
            continue;
        auto& same = drones[status->name];
        const auto is_it = [&](const auto* other) {  // under another reference
            return status_of(other).epoch == status->epoch && status_of(other).pid == status->pid;
        };
        if (std::ranges::none_of(same, is_it))
            same.push_back(&answer);
    }
    std::vector<Cause> causes;
    for (auto& [name, answers] : drones) {
        if (answers.size() < 2)
            continue;
        std::ranges::sort(answers, {}, [&](const auto* answer) { return status_of(answer).epoch; });
        auto& same = causes.emplace_back(cause(What::same_name, User{.drone = name},
                                               std::to_string(answers.size()) + " drones are called " + name
                                                   + ", so commands with this name alone are refused"));
        for (const auto* answer : answers)
            same.evidence += (same.evidence.empty() ? "the oldest first: " : ", ") + answer->drone;
        same.command = "hivectl stop " + answers.back()->drone;
    }
    return causes;
}

}  // namespace hive::explaining
