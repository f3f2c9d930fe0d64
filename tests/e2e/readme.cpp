// The shell commands of the READMEs, run as they stand there: every fenced block marked `sh`, all of one page in one swarm.
#include "measure.hpp"

#include <doctest/doctest.h>

#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

namespace fs = std::filesystem;

/// The contents of the blocks between ```sh and ```.
std::vector<std::string> shell_blocks(const fs::path& page)
{
    std::vector<std::string> blocks;
    std::ifstream in(page);
    bool inside = false;
    for (std::string line; std::getline(in, line);)
        if (!inside && line == "```sh") {
            inside = true;
            blocks.emplace_back();
        } else if (line.starts_with("```")) {
            inside = false;
        } else if (inside) {
            blocks.back() += line + "\n";
        }
    return blocks;
}

/// What a reader does and a script does not: commands that stream are left after a while by Ctrl-C.
constexpr auto reader = R"(set -euo pipefail
hivectl() {
    local code=0
    timeout -s INT "${patience}" "$program" "$@" || code=$?
    case "$1:$code" in top:124|results:124|exceptions:124) return 0 ;; esac
    return $code
}
command -v jq > /dev/null || jq() { cat; }
)";

void run_blocks(const std::string& name)
{
    const auto page = fs::path(HIVE_SOURCE_DIR) / name;
    const auto blocks = shell_blocks(page);
    REQUIRE_MESSAGE(!blocks.empty(), name, " has no block marked sh");
    const Swarm swarm;
    for (const auto& block : blocks) {
        const std::string values = "program=" + swarm.program("hivectl").string() + "\npatience=" + (sanitized() ? "15" : "3") + "\ncd " + swarm.home().string() + "\n";
        const auto finished = swarm.run({"/bin/bash", "-c", values + reader + block}, 60'000ms);
        CHECK_MESSAGE(finished.exit_code == 0, name, ": exit code ", finished.exit_code, " of\n", block, "\nit printed\n", finished.out, finished.err);
    }
}

}  // namespace

TEST_CASE("README: the commands on the front page work as they stand there") { run_blocks("README.md"); }

TEST_CASE("README: the commands on hivectl's page work as they stand there") { run_blocks("hivectl/README.md"); }
