#include "own_name.hpp"

#include <atomic>
#include <unistd.h>

namespace hivectl::dash {
namespace {

constexpr std::string_view prefix = "dash-";

}  // namespace

std::string own_name()
{
    static std::atomic<int> made{0};
    return std::string(prefix) + std::to_string(::getpid()) + "-" + std::to_string(++made);
}

void remove_pages(std::vector<hive::StatusAnswer>& answers)
{
    const auto is_page = [](const hive::EdgeStatus& edge) {  // the receiver would be "dash-1.input" if it were a drone
        return edge.receiver.starts_with(prefix) && edge.receiver.find('.') == std::string::npos;
    };
    for (auto& answer : answers)
        if (auto* status = std::get_if<hive::Status>(&answer.status))
            for (auto& output : status->outputs)
                std::erase_if(output.edges, is_page);
}

}  // namespace hivectl::dash
