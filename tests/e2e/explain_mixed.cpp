// hivectl explain: two causes at once, at random places of a line of drones, and causes while drones are started or
// replaced.
#include "explained.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <signal.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// A line of drones that were started in the background, so that the proposed commands can end and start them.
class Line {
public:
    Line()
    {
        swarm.hivectl_done({"start", "ticker", "--as", "source", "fps=50"});
        for (const auto* drone : {"worker", "last"})
            swarm.hivectl_done({"start", "sleeper", "--as", drone});
        swarm.hivectl_done({"connect", "source", "worker"});
        swarm.hivectl_done({"connect", "worker", "last"});
        REQUIRE(runs(swarm, "explain last"));
    }
    void signal(const std::string& drone, int number)
    {
        ::kill(static_cast<pid_t>(application.status(drone).pid), number);
    }

    const Swarm swarm{};
    hive::Application application = swarm.application();
};

struct Injection {
    std::string what;
    std::function<void(Line&, const std::string& drone)> inject;
};

const std::vector<Injection>& injections()
{
    static const std::vector<Injection> all{
        {"halted", [](Line& line, const std::string& drone) { line.application.halt(drone); }},
        {"suspended", [](Line& line, const std::string& drone) { line.signal(drone, SIGSTOP); }},
        {"not_running",
         [](Line& line, const std::string& drone) {
             line.signal(drone, SIGKILL);
             const auto is_gone = [&] {
                 const auto drones = line.application.drones();
                 return std::ranges::find(drones, drone) == drones.end();
             };
             REQUIRE(eventually(is_gone));
         }},
    };
    return all;
}

}  // namespace

TEST_CASE("explain: of two causes at two drones the one nearest to the source is named first, and cured first")
{
    const auto seed =
        std::getenv("HIVE_TEST_SEED") ? std::stoul(std::getenv("HIVE_TEST_SEED")) : std::random_device()();
    MESSAGE("HIVE_TEST_SEED=", seed);
    std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
    Line line;
    const std::vector<std::string> drones{"source", "worker", "last"};
    for (int round = 0; round < 6; ++round) {
        const auto first = random() % 2, second = first + 1 + random() % (2 - first);
        const auto &one = injections()[random() % injections().size()],
                   &two = injections()[random() % injections().size()];
        const std::string above = one.what + " " + drones[first], below = two.what + " " + drones[second];
        CAPTURE(above);
        CAPTURE(below);
        two.inject(line, drones[second]);
        one.inject(line, drones[first]);
        for (const std::string words : {"explain last --timeout 0.5", "explain --timeout 0.5"})
            awaited(line.swarm, words, above + ", " + below);
        cure(line.swarm, found(line.swarm, "explain last --timeout 0.5"));
        cure(line.swarm, awaited(line.swarm, "explain last --timeout 0.5", below));
        CHECK(runs(line.swarm, "explain last"));
    }
}

TEST_CASE("explain: while drones are replaced again and again, it names nothing that needs a cure, and finds what does")
{
    Line line;
    const auto replacing = [&](const std::string& drone) {
        return line.swarm.run({"/bin/sh", "-c", "hivectl replace " + drone}, 60'000ms).exit_code;
    };
    for (const std::string drone : {"worker", "source", "last"}) {
        CAPTURE(drone);
        auto replace = line.swarm.hivectl_running({"replace", drone}, "replace-" + drone);
        std::optional<int> code;
        do {
            const auto now = found(line.swarm, "explain last");
            CHECK_MESSAGE((now.runs() || now.causes == "starting " + drone), now.text());
            code = replace.wait(0ms);
        } while (!code);
        CHECK(code == 0);
        CHECK(eventually([&] { return found(line.swarm, "explain last").runs(); }));
    }
    line.application.halt("source");
    CHECK(replacing("worker") == 0);
    cure(line.swarm, awaited(line.swarm, "explain last", "halted source"));
    CHECK(runs(line.swarm, "explain last"));
}

TEST_CASE("explain: while a swarm is brought up, drones that are not ready are starting")
{
    const Swarm swarm;
    const auto file = swarm.home() / "slow.json";
    std::ofstream(file) << R"({"swarm": "slow", "drones": {"source": {"kind": "ticker"},)"
                           R"( "slow": {"kind": "sleeper", "set": {"start_ms": 4000}}}, "connections": [)"
                           R"({"from": "source", "to": "slow"}]})";
    const auto up = swarm.hivectl_running({"up", file.string()}, "up");
    REQUIRE(eventually([&] { return std::filesystem::exists(swarm.home() / "slow.lock"); }));
    const auto starting = awaited(swarm, "explain slow", "starting slow");
    cure(swarm, starting);
    CHECK(eventually([&] { return found(swarm, "explain slow").runs(); }));
    swarm.hivectl_done({"down", file.string()});
}
