#include "own_name.hpp"

#include <atomic>
#include <unistd.h>

namespace hivectl::dash {
namespace {

std::string prefix() { return "dash-" + std::to_string(::getpid()) + "-"; }

}  // namespace

std::string own_name()
{
    static std::atomic<int> made{0};
    return prefix() + std::to_string(++made);
}

void remove_own(std::vector<hive::StatusAnswer>& answers)
{
    for (auto& answer : answers)
        for (auto& output : answer.status.outputs)
            std::erase_if(output.edges, [own = prefix()](const auto& edge) { return edge.receiver.starts_with(own); });
}

}  // namespace hivectl::dash
