// The ready-made swarms, exported for each engine and run by a fake of it: the command lines alone, in any order, each
// killed once, and all restarted after a reboot, give the same swarm as `hivectl up`.
#include "engine_lab.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <algorithm>
#include <random>
#include <set>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// The running swarm: as a file without addresses, and its connections.
struct Snapshot {
    Json plan;
    std::set<std::string> connections;
    std::set<std::string> sinks;
    bool operator==(const Snapshot&) const = default;
};

Snapshot snapshot_of(const std::string& plan, const std::string& edges)
{
    Snapshot snapshot{Json::parse(plan), {}, {}};
    for (auto& drone : snapshot.plan.at("drones"))
        for (const char* key : {"on", "listen", "advertise", "key"})
            drone.erase(key);
    std::set<std::string> senders, receivers;
    const auto drone_of = [](const Json& end) {
        return end.get<std::string>().substr(0, end.get<std::string>().find('.'));
    };
    for (const auto& edge : Json::parse(edges)) {
        std::string text;
        for (const char* key : {"from", "to", "kind", "transfer", "delivery", "window", "group", "state"})
            text += edge.at(key).dump() + " ";
        snapshot.connections.insert(text);
        if (edge.at("to").get<std::string>().find('.') == std::string::npos)
            continue;  // a group
        senders.insert(drone_of(edge.at("from")));
        receivers.insert(drone_of(edge.at("to")));
    }
    std::ranges::set_difference(receivers, senders, std::inserter(snapshot.sinks, snapshot.sinks.end()));
    return snapshot;
}

class Trial {
public:
    Trial(const std::string& form, const std::string& swarm, std::mt19937_64& random)
        : lab_(form, file_of(swarm)), random_(random), swarm_(swarm), is_script_(form == "shell")
    {
        lab_.shell_done("hivectl up " + file_of(swarm) + " --timeout 60");
        as_brought_up_ = snapshot();
        REQUIRE(!as_brought_up_.sinks.empty());
        lab_.shell_done("hivectl down");
        lab_.reboot();  // nothing of it remains for the next steps
    }

    void run()
    {
        start_all();
        works("started");
        for (const auto& drone : in_any_order()) {
            lab_.kill(drone);
            lab_.start(drone);
            works(drone + " was killed");
        }
        lab_.reboot();
        start_all();
        works("after the reboot");
    }

private:
    static std::string file_of(const std::string& swarm)
    {
        return HIVE_SOURCE_DIR "/scripts/swarms/" + swarm + ".json";
    }
    [[nodiscard]] Snapshot snapshot() const
    {
        return snapshot_of(lab_.shell_done("hivectl export --swarm " + swarm_),
                           lab_.shell_done("hivectl connections --json"));
    }
    /// A script has an order.
    [[nodiscard]] std::vector<std::string> in_any_order()
    {
        auto drones = lab_.drones();
        if (!is_script_)
            std::ranges::shuffle(drones, random_);
        return drones;
    }
    void start_all()
    {
        for (const auto& drone : in_any_order())
            lab_.start(drone);
        lab_.finish();
    }
    void works(const std::string& when) const
    {
        CAPTURE(when);
        for (const auto& drone : lab_.drones())
            CHECK_MESSAGE(eventually([&] { return lab_.is_well(drone); }, 60'000ms), drone, " is not well");
        for (const auto& sink : as_brought_up_.sinks)
            CHECK_MESSAGE(lab_.shell("hivectl results " + sink + " -n 3 --timeout 60").exit_code == 0, sink);
        Snapshot now;
        const bool same = eventually([&] { return (now = snapshot()) == as_brought_up_; }, 60'000ms);
        CHECK_MESSAGE(same, now.plan.dump(), " with ", Json(now.connections).dump(), " instead of ",
                      as_brought_up_.plan.dump(), " with ", Json(as_brought_up_.connections).dump());
    }

    EngineLab lab_;
    std::mt19937_64& random_;
    std::string swarm_;
    bool is_script_;
    Snapshot as_brought_up_;
};

void try_form(const std::string& form)
{
    if (!possible(missing_for_engines()))
        return;
    const char* told = std::getenv("HIVE_TEST_SEED");
    const auto seed = told ? std::strtoull(told, nullptr, 10) : std::random_device()();
    CAPTURE(seed);  // replay with HIVE_TEST_SEED=...
    std::mt19937_64 random(seed);
    std::vector<std::string> swarms{"axis", "face", "gesture", "shared-face", "tracking"};
    std::ranges::shuffle(swarms, random);
    const char* rounds = std::getenv("HIVE_TEST_ROUNDS");  // 5: all of them
    swarms.resize(std::min(swarms.size(), rounds ? std::stoul(rounds) : 2));
    for (const auto& swarm : swarms) {
        CAPTURE(swarm);
        Trial(form, swarm, random).run();
    }
}

}  // namespace

TEST_CASE("engines: the command lines of the units of systemd make the swarm") { try_form("systemd"); }
TEST_CASE("engines: the command lines of the containers of compose make the swarm") { try_form("compose"); }
TEST_CASE("engines: the command lines of the pods of Kubernetes make the swarm") { try_form("kubernetes"); }
TEST_CASE("engines: the command lines of the steps of Slurm make the swarm") { try_form("slurm"); }
TEST_CASE("engines: the commands of the shell script make the swarm") { try_form("shell"); }
