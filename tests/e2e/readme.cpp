// Runs the shell commands of the READMEs and the examples of --help unchanged: of a README every fenced block marked
// `sh`, each page in one swarm.
#include "reader.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <fstream>
#include <set>
#include <sstream>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

namespace fs = std::filesystem;

/// The commands under "examples:" of a verb's help, without their descriptions.
std::vector<std::string> examples(const Swarm& swarm, const std::string& verb)
{
    std::istringstream help(swarm.hivectl_done({verb, "--help"}));
    std::vector<std::string> commands;
    bool inside = false;
    for (std::string line; std::getline(help, line);) {
        if (inside && line.starts_with("  "))
            commands.push_back(line.substr(2, line.find("  ", 2) - 2));
        inside = inside || line == "examples:";
    }
    return commands;
}

void run_blocks(const std::string& name)
{
    const auto page = fs::path(HIVE_SOURCE_DIR) / name;
    const auto blocks = shell_blocks(page);
    REQUIRE_MESSAGE(!blocks.empty(), name, " has no block marked sh");
    const Swarm swarm;
    for (const auto& block : blocks) {
        const auto finished = run_as_reader(swarm, block, sanitized() ? 15 : 3);
        CHECK_MESSAGE(finished.exit_code == 0, name, ": exit code ", finished.exit_code, " of\n", block,
                      "\nit printed\n", finished.out, finished.err);
    }
}

/// Preparations for the examples of a verb.
struct Verb {
    std::string name, before;
};

const std::vector<Verb> verbs{{"start", ""},
                              {"ps", ""},
                              {"describe", "hivectl start face"},
                              {"audit", ""},
                              {"check", "cp " HIVE_SOURCE_DIR "/scripts/swarms/face.json doorway.json"},
                              {"schema", ""},
                              {"export", ""},
                              {"connect", ""},
                              {"connections", ""},
                              {"explain", ""},
                              {"advise", ""},
                              {"metrics", "echo secret > metrics.token"},
                              {"dash", ""},
                              {"snap", ""},
                              {"put", "hivectl snap camera photo.jpg; hivectl snap camera photo.png"},
                              {"set", ""},
                              {"get", ""},
                              {"results", ""},
                              {"collect", "hivectl start camera --as left; hivectl start camera --as right"},
                              {"record", "hivectl stop left right"},
                              {"replay", ""},
                              {"save", ""},
                              {"top", ""},
                              {"exceptions", "echo no image | hivectl put face - --type image/jpeg"},
                              {"disconnect", ""},
                              {"halt", ""},
                              {"wait", ""},
                              {"place", ""},
                              {"logs", ""},
                              {"resume", ""},
                              {"key", ""},
                              {"completion", ""},
                              {"devices", ""},
                              {"stop", ""}};

}  // namespace

TEST_CASE("README: the commands on the front page work as they stand there") { run_blocks("README.md"); }

TEST_CASE("README: the commands on hivectl's page work as they stand there") { run_blocks("hivectl/README.md"); }

TEST_CASE("README: the commands on the page of the swarm file work as they stand there")
{
    run_blocks("libhive/docs/swarm-file.md");
}

TEST_CASE("README: the commands on the page that asks whether it works do so as they stand there")
{
    run_blocks("libhive/docs/is-it-working.md");
}

TEST_CASE("README: the commands on the page of metrics work as they stand there")
{
    run_blocks("libhive/docs/metrics.md");
}

TEST_CASE("README: hivectl --help has each heading once")
{
    const Swarm swarm;
    std::istringstream help(swarm.hivectl_done({"--help"}));
    std::set<std::string> headings;
    for (std::string line; std::getline(help, line);)
        if (line.ends_with(":") && !line.starts_with(" "))
            CHECK_MESSAGE(headings.insert(line).second, line, " stands there twice");
    CHECK(headings.contains("results:"));
}

TEST_CASE("README: a command line that cannot be read is a failure as any other, with --json as a value")
{
    const Swarm swarm;
    for (const auto& verb : verbs) {
        const auto wrong = swarm.hivectl({verb.name, "--json", "--no-such-option"});
        CHECK(wrong.exit_code == 2);
        const auto error = hive::Json::parse(wrong.err).at("error");
        CHECK(error.at("code") == "invalid_argument");
        CHECK(error.at("advice").get<std::string>().ends_with("--help"));
    }
    const auto broken = (swarm.home() / "broken.json").string();
    std::ofstream(broken) << R"({"swarm": "x", "drones": {"a": {"kind": "no such kind"}}})";
    const std::vector<std::pair<std::vector<std::string>, std::string>> others{
        {{"up", broken}, "invalid_argument"},
        {{"down", broken}, "invalid_argument"},
        {{"export", "--as", "shell", "--from", broken}, "invalid_argument"},
        {{"wait", "face", "--timeout", "0.1"}, "timeout"},
    };
    for (auto [words, code] : others) {
        words.emplace_back("--json");
        const auto failed = swarm.hivectl(words);
        CHECK(failed.exit_code != 0);
        CHECK_MESSAGE(hive::Json::parse(failed.err).at("error").at("code") == code, failed.err);
    }
    const auto unknown = swarm.hivectl({"colect", "--json"});
    CHECK(unknown.exit_code == 2);
    CHECK(hive::Json::parse(unknown.err).at("error").at("advice") == "did you mean collect?");
}

TEST_CASE("README: the examples of --help work as they stand there")
{
    if (!possible(missing_if_sanitized()))
        return;  // the same verbs as on the pages, a hundred times
    const Swarm swarm;
    for (const auto& verb : verbs) {
        CHECK(run_as_reader(swarm, verb.before, 1).exit_code == 0);
        const auto commands = examples(swarm, verb.name);
        CHECK_MESSAGE(!commands.empty(), verb.name, " has no examples");
        for (const auto& command : commands) {
            const auto finished = run_as_reader(swarm, command, 1);
            CHECK_MESSAGE(finished.exit_code == 0, "exit code ", finished.exit_code, " of ", command, "\nit printed\n",
                          finished.out, finished.err);
        }
    }
}
