// Runs the commands of the pages in libhive/docs/ about one machine, a few machines, Slurm and Kubernetes unchanged.
// Fakes replace systemd, the container engine and the Kubernetes cluster.
#include "engine_lab.hpp"
#include "free_port.hpp"
#include "reader.hpp"
#include "slurm_lab.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <fstream>
#include <sstream>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

namespace fs = std::filesystem;

std::vector<std::string> blocks_of(const std::string& page)
{
    auto blocks = shell_blocks(fs::path(HIVE_SOURCE_DIR) / "libhive/docs" / page);
    REQUIRE_MESSAGE(!blocks.empty(), page, " has no block marked sh");
    return blocks;
}

std::string commands_of(const std::string& page)
{
    std::string commands;
    for (const auto& block : blocks_of(page))
        commands += block;
    return commands;
}

void replace(std::string& text, const std::string& from, const std::string& to)
{
    REQUIRE_MESSAGE(text.find(from) != std::string::npos, from, " is on the page no more");
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

std::ptrdiff_t results_in(const std::string& printed)
{
    std::ptrdiff_t count = 0;
    for (auto at = printed.find("\"seq\""); at != std::string::npos; at = printed.find("\"seq\"", at + 1))
        ++count;
    return count;
}

/// A fake systemctl runs the units; of containers it checks everything that needs no engine.
constexpr auto stand_ins = R"(
unset XDG_CONFIG_HOME HIVE_KEY
export HOME=$PWD
trap 'kill $(jobs -p) 2> /dev/null || true' EXIT
trap 'echo "failed: $BASH_COMMAND" >&2' ERR
unknown() { echo "what would $* do?" >&2; return 2; }
systemctl() {
    local units=~/.config/systemd/user unit
    case "$*" in
        '--user daemon-reload') ;;
        '--user enable --now hive-doorway.target')
            for unit in $(sed -n 's/^Wants=//p' "$units/hive-doorway.target"); do
                $(sed -n 's/^ExecStart=//p' "$units/$unit") >> drones.log 2>&1 &
            done ;;
        '--user disable --now hive-doorway.target') kill $(jobs -p) && wait ;;
        *) unknown systemctl "$@" ;;
    esac
}
docker() {
    case "$*" in
        build\ -t\ *\ -f\ *\ build/release/packages) [ -f "$clone/$5" ] && image=$3 ;;
        "push ${image-}") ;;
        *) unknown docker "$@" ;;
    esac
}
docker-compose() {
    grep -q "image: \"$image\"" compose.yaml
    type -P docker-compose > /dev/null || return 0
    case "$*" in
        '-p doorway up -d' | '-p doorway down') command docker-compose -p doorway config -q ;;
        '-p doorway exec '*) command docker-compose -p doorway config --services | grep -x "$4" ;;
        *) unknown docker-compose "$@" ;;
    esac
}
kubectl() {
    local all all_words="$*"
    all=$(command kubectl kustomize doorway)
    grep -q "image: $image\$" <<< "$all"
    case "$*" in
        'kustomize doorway') echo "$all" ;;
        'apply -k doorway' | 'delete -k doorway') ;;
        *' deployment/'*)
            local name=${all_words#* deployment/}
            grep -A 8 '^kind: Deployment' <<< "$all" | grep "^  name: ${name%% *}\$" ;;
        *) unknown kubectl "$@" ;;
    esac
}
)";

/// A result of a live source that arrives before all workers are received is missing, hence exit code 8.
constexpr auto live = R"live(eval "$(declare -f hivectl | sed '1s/hivectl/told/')"
hivectl() { told "$@" || [ "$1:$?" = results:8 ]; }
)live";

/// Runs a page, and returns the swarm file that it writes.
std::string run_page(const Swarm& swarm, const std::string& page)
{
    const auto commands = commands_of(page) + "[ \"$(hivectl ps --json)\" = '[]' ]\n";
    const auto done = run_as_reader(swarm, std::string("clone=" HIVE_SOURCE_DIR "\n") + stand_ins + live + commands,
                                    sanitized() ? 15 : 5);
    CHECK_MESSAGE(done.exit_code == 0, "exit code ", done.exit_code, " of\n", commands, "\nit printed\n", done.out,
                  done.err);
    return (swarm.home() / "doorway.json").string();
}

/// The commands of a page in a container: the lines with a keyword, followed by the drone.
void run_in_containers(const std::string& page, const std::string& form, const std::string& file,
                       const std::string& word)
{
    if (!possible(missing_for_engines()))
        return;
    EngineLab lab(form, file);
    for (const auto& drone : lab.drones())
        lab.start(drone);
    lab.finish();
    std::istringstream lines(commands_of(page));
    int count = 0;
    for (std::string line; std::getline(lines, line);) {
        const auto found = line.find(word);
        if (found == std::string::npos)
            continue;
        std::istringstream words(line.substr(found + word.size()));
        std::string drone;
        words >> drone;
        std::vector<std::string> command;
        for (std::string next; words >> next;)
            if (next != "--")
                command.push_back(next);
        const auto done = lab.beside(drone, command);
        CHECK_MESSAGE(done.exit_code == 0, line, "\n", done.err);
        CHECK_MESSAGE(!done.out.empty(), line);
        ++count;
    }
    CHECK(count > 0);
}

}  // namespace

TEST_CASE("pages: the commands on the page of one machine work as they stand there")
{
    const Swarm swarm;
    const auto file = run_page(swarm, "one-machine.md");
    run_in_containers("one-machine.md", "compose", file, "docker-compose -p doorway exec ");
}

TEST_CASE("pages: the commands on the page of a few machines work as they stand there")
{
    if (!possible(missing_for_lab()))
        return;
    const Lab lab({"cam1", "gpu1", "gpu2"});
    // The source is live, so a result that arrives before all workers are received is missing, hence exit code 8.
    const std::string reader = "cd; set -e\nhivectl() { command hivectl \"$@\" || [ \"$1:$?\" = results:8 ]; }\n";
    std::string printed;
    for (const auto& block : blocks_of("a-few-machines.md"))
        printed += lab.shell_done(reader + block);
    CHECK_MESSAGE(results_in(printed) == 4, printed);
    CHECK(lab.hivectl_done("ps --json") == "[]\n");
    for (std::size_t i = 0; i < 3; ++i)
        CHECK(fs::exists(lab.machine(i).swarm.home() / ".config/systemd/user/hive-doorway.target"));
}

TEST_CASE("pages: the commands on the page of Slurm work as they stand there")
{
    if (!possible(missing_for_slurm()))
        return;
    const SlurmLab lab;
    auto commands = commands_of("slurm.md");
    for (const std::string node : {"n1", "n2", "n3"}) {  // one machine here, whose ports they share
        const auto address = "tcp://127.0.0.1:" + std::to_string(free_port());
        replace(commands, "\"on\": \"" + node + '"', "\"on\": \"" + node + R"(", "listen": ")" + address + '"');
        replace(commands, "tcp://" + node + ":7700", address);
    }
    const std::string readers_timeout = R"(set -e
cd "$HIVE_HOME"
unset SLURM_JOB_ID
sbatch() { env --unset=HIVE_HOME sbatch "$@"; }
hivectl() {
    local tries=0
    until command hivectl "$@"; do
        [ "$1:$?" = results:8 ] && return
        [ "$1" = place ] && [ $((tries += 1)) -lt 100 ] && sleep 0.2 || return 1
    done
}
)";
    std::ofstream(lab.swarm().home() / "page.sh") << readers_timeout << commands;
    const auto done = lab.shell("exec /bin/bash \"$HIVE_HOME/page.sh\"");
    CHECK_MESSAGE(done.exit_code == 0, "exit code ", done.exit_code, " of\n", commands, "\nit printed\n", done.out,
                  done.err);
    CHECK_MESSAGE(results_in(done.out) == 8, done.out, done.err);  // in the allocation, and for the job
    CHECK(eventually([&] { return lab.shell_done("squeue --noheader --format=%i") == lab.job() + "\n"; }, 30'000ms));
}

TEST_CASE("pages: the commands on the page of Kubernetes work as they stand there")
{
    const Swarm swarm;
    if (!possible(swarm.run({"/bin/sh", "-c", "command -v kubectl"}).exit_code == 0 ? "" : "kubectl"))
        return;
    const auto file = run_page(swarm, "kubernetes.md");
    run_in_containers("kubernetes.md", "kubernetes", file, "kubectl exec deployment/doorway-");
}
