// Writing swarm files: what is written reads as the same plan, whatever it says.
#include <hive/swarm_plan.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>

using namespace hive;

namespace {

std::uint64_t seed()
{
    const char* text = std::getenv("HIVE_TEST_SEED");
    return text ? std::strtoull(text, nullptr, 10) : std::random_device()();
}

class Dice {
public:
    explicit Dice(std::uint64_t start) : engine_(start) {}
    std::size_t below(std::size_t end) { return engine_() % end; }
    bool yes() { return below(3) == 0; }
    template <class Item>
    Item one_of(std::initializer_list<Item> items)
    {
        return *std::next(items.begin(), static_cast<std::ptrdiff_t>(below(items.size())));
    }

private:
    std::mt19937_64 engine_;
};

Json any_value(Dice& dice)
{
    return dice.one_of<Json>({1, -3, 1.05, 0.1, 1e300, true, false, "", "text", "\"quoted\"\n\\",
                              "\xC3\xA4 \xF0\x9F\x90\x9D", static_cast<double>(dice.below(1u << 30)) / 977});
}

SwarmDrone any_drone(Dice& dice, std::size_t number)
{
    SwarmDrone drone{.name = dice.one_of<std::string>({"d", "zoom.", "a-b_", "7"}) + std::to_string(number),
                     .kind = dice.one_of<std::string>({"face", "edges.py"})};
    if (dice.yes())
        drone.host = dice.one_of<std::string>({"cam1", "user@gpu-2.lab"});
    for (std::size_t i = 0; i < dice.below(4); ++i)
        drone.set["p" + std::to_string(dice.below(5))] = any_value(dice);
    drone.restart = dice.one_of({Restart::never, Restart::on_failure, Restart::always});
    drone.on_exception = dice.one_of<std::string>({"", "skip", "halt"});
    drone.log_level = dice.one_of<std::string>({"", "off", "info"});
    drone.key = dice.one_of<std::string>({"", "/home/user/a key"});
    if (dice.yes()) {
        drone.listen = dice.one_of<std::string>({"tcp://0.0.0.0", "tcp://[::]:" + std::to_string(1000 + number)});
        drone.advertise = dice.one_of<std::string>({"", "tcp://cam1"});
    }
    for (const auto& field : order_fields())
        if (field.type == OrderField::Type::flag)
            field.set(drone, dice.yes());
    return drone;
}

ConnectionOptions any_options(Dice& dice, const std::string& sender)
{
    ConnectionOptions options;
    options.encoding = dice.one_of<std::string>({"", "png", "jpeg:60"});
    if (dice.yes()) {
        options.group = dice.one_of<std::string>({sender, "others"});
        options.window = 1 + static_cast<int>(dice.below(64));
        if (dice.yes())
            options.lease = std::chrono::milliseconds(50 + dice.below(86'399'950));
        return options;
    }
    options.first_frame = dice.yes();
    if (dice.yes())
        options.transfer = Transfer::streaming;
    else
        options.window = 1 + static_cast<int>(dice.below(3));
    if (options.encoding.empty() && dice.yes())
        options.delivery = Delivery::notification;
    return options;
}

SwarmPlan any_plan(Dice& dice)
{
    SwarmPlan plan{.name = "s" + std::to_string(dice.below(100)), .drones = {}, .connections = {}, .engines = {}};
    for (std::size_t i = 0; i < dice.below(12); ++i)
        plan.drones.push_back(any_drone(dice, i));
    std::set<std::size_t> pairs;
    for (std::size_t i = 0; !plan.drones.empty() && i < dice.below(30); ++i) {
        const auto from = dice.below(plan.drones.size()), to = dice.below(plan.drones.size());
        if (from == to || !pairs.insert(from * 100 + to).second)
            continue;
        const auto& sender = plan.drones[from].name;
        plan.connections.push_back({{sender, dice.yes() ? "out" : ""},
                                    {plan.drones[to].name, dice.yes() ? "in" : ""},
                                    any_options(dice, sender)});
    }
    for (const auto& drone : plan.drones)
        if (dice.yes() && std::ranges::find(plan.engines, drone.host, [](const auto& one) {
                              return one.first;
                          }) == plan.engines.end())
            plan.engines.emplace_back(
                drone.host,
                dice.one_of<SwarmEngine>({{"local", Json::object()},
                                          {"systemd", Json::object()},
                                          {"ssh", "x@y"},
                                          {"slurm", {{"partition", "gpu"}, {"options", {"--gres=gpu:1", "-v"}}}}}));
    return plan;
}

}  // namespace

TEST_CASE("swarm text: a line for each drone and each connection, without what is as usual")
{
    SwarmPlan plan{.name = "doorway",
                   .drones = {{.name = "camera",
                               .kind = "camera",
                               .host = "cam1",
                               .set = {{"fps", 30}, {"source", "/dev/video0"}}},
                              {.name = "face-1", .kind = "face", .restart = Restart::on_failure},
                              {.name = "face-2", .kind = "face", .halted = true}},
                   .connections = {{{"camera", ""}, {"face-1", ""}, {.window = 2, .group = "camera"}},
                                   {{"camera", ""}, {"face-2", ""}, {.window = 2, .group = "camera"}},
                                   {{"face-1", "faces"}, {"face-2", "in"}, {.lease = std::chrono::milliseconds(1500)}}},
                   .engines = {{"cam1", {"ssh", "lab-cam1"}}}};
    CHECK_EQ(to_text(plan), R"({
  "swarm": "doorway",
  "drones": {
    "camera": {"kind": "camera", "on": "cam1", "set": {"fps": 30, "source": "/dev/video0"}},
    "face-1": {"kind": "face", "restart": "on-failure"},
    "face-2": {"kind": "face", "halted": true}
  },
  "connections": [
    {"from": "camera", "to": ["face-1", "face-2"], "window": 2, "share": true},
    {"from": "face-1.faces", "to": "face-2.in", "lease": 1.5}
  ],
  "engines": {
    "cam1": {"ssh": "lab-cam1"}
  }
}
)");
    CHECK_EQ(to_text(SwarmPlan{.name = "none", .drones = {}, .connections = {}, .engines = {}}),
             "{\n  \"swarm\": \"none\",\n  \"drones\": {}\n}\n");
}

TEST_CASE("swarm text: reading what was written gives the same plan")
{
    const auto start = seed();
    CAPTURE(start);  // HIVE_TEST_SEED=... does it again
    Dice dice(start);
    for (int i = 0; i < 300; ++i) {
        const auto plan = any_plan(dice);
        const auto text = to_text(plan);
        CAPTURE(text);
        const auto reading = read_swarm(text);
        for (const auto& mistake : reading.mistakes)
            FAIL(mistake.line << ":" << mistake.column << ": " << mistake.text);
        REQUIRE(reading.plan == plan);
        REQUIRE_EQ(to_text(reading.plan), text);
    }
}

TEST_CASE("swarm text: a file with a wrong byte is read or has a mistake inside it, and nothing else happens")
{
    const auto start = seed();
    CAPTURE(start);
    Dice dice(start);
    for (int i = 0; i < 2000; ++i) {
        auto text = to_text(any_plan(dice));
        for (std::size_t changes = 1 + dice.below(3); changes > 0; --changes)
            text[dice.below(text.size())] =
                dice.one_of({'"', '{', '}', '[', ']', ',', ':', '\\', '0', ' ', '\n', '*', '\xC3', '/', '\0'});
        if (dice.yes())
            text.resize(dice.below(text.size()));
        CAPTURE(text);
        const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n')) + 1;
        for (const auto& mistake : read_swarm(text).mistakes) {
            REQUIRE_GE(mistake.line, 1u);
            REQUIRE_LE(mistake.line, lines);
            REQUIRE_GE(mistake.column, 1u);
            REQUIRE_LE(mistake.column, text.size() + 1);
        }
    }
}
