// Swarm files that grow up: comments, variables, defaults and included files, and mistakes in all of them.
#include <hive/swarm_plan.hpp>

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include <unistd.h>

using namespace hive;

namespace {

std::string told(const SwarmReading& reading)
{
    std::string text;
    for (const auto& mistake : reading.mistakes)
        text += mistake.file + ":" + std::to_string(mistake.line) + ":" + std::to_string(mistake.column) + ": "
                + mistake.text + (mistake.advice.empty() ? "" : "; " + mistake.advice) + "\n";
    return text;
}

SwarmPlan good(const std::string& text, const SwarmContext& context = {})
{
    auto reading = read_swarm(text, {}, context);
    CHECK_EQ(told(reading), "");
    return std::move(reading.plan);
}

/// A folder with files, for as long as a test takes.
class Folder {
public:
    Folder() { std::filesystem::create_directories(path_); }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    void write(const std::string& name, const std::string& text) const
    {
        std::filesystem::create_directories((path_ / name).parent_path());
        std::ofstream(path_ / name) << text;
    }
    [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }
    [[nodiscard]] SwarmContext context() const { return {.folder = path_, .variables = {}}; }

private:
    std::filesystem::path path_ =
        std::filesystem::temp_directory_path() / ("hive-assembly-" + std::to_string(::getpid()));
};

}  // namespace

TEST_CASE("swarm file: comments are left out, also in front, and places stay as they are")
{
    CHECK_EQ(good("// of the door\n{\"swarm\": \"s\", // \"}\n\"drones\": {\"a\": {\"kind\": \"k\"}}} // end")
                 .drones.at(0)
                 .name,
             "a");
    CHECK_EQ(good(R"({"swarm": "s", "drones": {"a": {"kind": "k", "set": {"url": "http://x\"//y"}}}})")
                 .drones.at(0)
                 .set["url"],
             "http://x\"//y");
    CHECK_EQ(told(read_swarm("{\"swarm\": \"s\", // Tür\n\"drones\": {\"a\": /* no */ {}}}")),
             ":2:17: comments start with // and end with the line\n");
    CHECK_EQ(told(read_swarm("{\"swarm\": \"s\", // x\n\"drones\": {\"a\": {\"kind\": 3}}} // y")),
             ":2:26: \"kind\" must be a text, not 3\n");
}

TEST_CASE("swarm file: variables have the value of the file, or that of the command line")
{
    const std::string text = R"({"swarm": "s-${gate}", "variables": {"gate": "7", "n": 2, "fast": false, "fps": null},
"drones": {"a": {"kind": "k", "count": "${n}", "halted": "${fast}",
  "set": {"fps": "${fps}", "title": "gate ${gate} of ${n}", "plain": "$${gate} $5"}}}})";
    const auto plan = good(text, {.folder = {}, .variables = {{"fps", "12.5"}, {"gate", "08"}}});
    CHECK_EQ(plan.name, "s-08");
    REQUIRE_EQ(plan.drones.size(), 2u);
    CHECK_FALSE(plan.drones[0].halted);
    CHECK_EQ(plan.drones[0].set, Json({{"fps", 12.5}, {"title", "gate 08 of 2"}, {"plain", "${gate} $5"}}));
    CHECK_EQ(good(to_text(plan)), plan);
    CHECK_EQ(told(read_swarm(text)), ":3:18: the variable \"fps\" has no value; give it one: --set fps=VALUE\n");
    CHECK_EQ(told(read_swarm(text, {}, {.folder = {}, .variables = {{"fps", "1"}, {"gaet", "1"}}})),
             ":1:24: there is no variable \"gaet\" to be set; did you mean gate?\n");
    CHECK_EQ(told(read_swarm(
                 R"({"swarm": "s", "variables": {"n": []}, "drones": {"a": {"kind": "${k}", "count": "${m"}}})")),
             ":1:35: \"n\" must be a number, a text, true, false or null, not an empty list\n"
             ":1:65: there is no variable \"k\"; add it to the file: \"variables\": {\"k\": VALUE}\n"
             ":1:82: ${ without a }; a variable is ${NAME}; write $${ for ${ itself\n");
}

TEST_CASE("swarm file: a drone takes from the defaults of its kind what it does not say")
{
    const auto plan = good(R"({"swarm": "s", "defaults": {"k": {"set": {"x": 1, "y": 1}, "restart": "always"}},
"drones": {"a": {"kind": "k", "set": {"x": 2}}, "b": {"kind": "l"}, "c": {"kind": "k", "restart": "never"}}})");
    CHECK_EQ(plan.drones[0].set, Json({{"x", 2}, {"y", 1}}));
    CHECK_EQ(plan.drones[0].restart, Restart::always);
    CHECK_EQ(plan.drones[1].set, Json::object());
    CHECK_EQ(plan.drones[2].restart, Restart::never);
    CHECK_EQ(told(read_swarm(R"({"swarm": "s", "defaults": {"k": {"set": {"x": []}, "rstart": 1}, "face": {}},
"drones": {"a": {"kind": "k"}, "b": {"kind": "k"}}})")),
             ":1:48: \"x\" must be a number, string or boolean, not an empty list\n"
             ":1:53: a drone has no key \"rstart\"; did you mean \"restart\"?\n"
             ":1:67: no drone of this file is of the kind \"face\"\n");
}

TEST_CASE("swarm file: included files, of which the including one changes what it names again")
{
    const Folder folder;
    folder.write("parts/cameras.json", R"({"swarm": "other", "include": "more.json", "variables": {"fps": 5},
"drones": {"camera": {"kind": "c", "set": {"fps": "${fps}", "faces": 1}}},
"connections": [{"from": "camera", "to": "v"}]})");
    folder.write("parts/more.json",
                 R"({"defaults": {"v": {"halted": true}, "unused": {}}, "drones": {"v": {"kind": "v"}}})");
    const std::string text = R"({"swarm": "s", "include": ["parts/cameras.json"], "variables": {"fps": 30},
"drones": {"a": {"kind": "v"}, "camera": {"set": {"faces": 2}}}, "connections": [{"from": "camera", "to": "a"}]})";
    const auto plan = good(text, folder.context());
    CHECK_EQ(plan.name, "s");
    REQUIRE_EQ(plan.drones.size(), 3u);
    CHECK_EQ(plan.drone("camera")->set, Json({{"faces", 2}, {"fps", 30}}));
    CHECK(plan.drone("a")->halted);
    CHECK(plan.drone("v")->halted);
    CHECK_EQ(plan.connections.size(), 2u);
    CHECK(told(read_swarm(text))
              .starts_with(":1:28: parts/cameras.json is not included: where this file is, is not known\n"));
}

TEST_CASE("swarm file: mistakes of included files are told with their file, and a file that is missing only once")
{
    const Folder folder;
    folder.write("a.json", "{\"drones\": {\n  \"a\": {\"kind\": \"k\", \"cuont\": 2}}, \"dronse\": 1}");
    folder.write("b.json", "{\"drones\": {,}");
    folder.write("c.json", R"({"include": "c.json", "drones": []})");
    const auto reading = read_swarm(R"({"swarm": "s", "include": ["a.json", "b.json", "c.json", "d.json"],
"drones": {"x": {"kind": "k"}}, "connections": [{"from": "x", "to": "y"}], "engines": 1})",
                                    {}, folder.context());
    CHECK_EQ(told(reading),
             ":1:58: " + folder.path("d.json")
                 + " is not a file that can be included; write its path as seen from "
                   "this file\n"
                   ":2:87: \"engines\" must be an object, not 1\n"
                 + folder.path("a.json") + ":2:22: a drone has no key \"cuont\"; did you mean \"count\"?\n"
                 + folder.path("a.json") + ":2:36: a swarm file has no key \"dronse\"; did you mean \"drones\"?\n"
                 + folder.path("b.json") + ":1:13: JSON with unexpected input\n" + folder.path("c.json")
                 + ":1:13: " + folder.path("c.json") + " includes itself\n" + folder.path("c.json")
                 + ":1:23: \"drones\" is not of the same type as in the including file\n");
}
