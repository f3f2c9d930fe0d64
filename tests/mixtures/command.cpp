#include "command.hpp"

namespace hive::mixtures {
namespace {

using namespace std::chrono_literals;

const std::string name = "results";  // of its log

std::vector<std::string> words_of(const Topology& topology)
{
    std::vector<std::string> words{"results"};
    if (topology.ordered)
        words.emplace_back("--ordered");
    const auto& drones = topology.stages.back().drones;
    words.insert(words.end(), drones.begin(), drones.end());
    return words;
}

}  // namespace

Command::Command(const test::Swarm& swarm, const Topology& topology)
    : swarm_(swarm), process_(swarm.hivectl_running(words_of(topology), name))
{
}

Printed Command::exited(std::chrono::milliseconds timeout)
{
    const auto code = process_.wait(timeout);
    auto printed = printed_in(swarm_.log(name), code.value_or(-1));
    if (!code)
        printed.complaints += "it still runs\n";
    return printed;
}

std::vector<std::string> Command::fallen()
{
    if (const auto code = process_.wait(0ms))
        return {"hivectl results ended by itself with " + std::to_string(*code) + ":\n" + swarm_.log(name)};
    return {};
}

}  // namespace hive::mixtures
