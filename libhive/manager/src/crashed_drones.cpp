// Reads one small file per drone, NAME.crash, written by the crashing process.
#include "crashed_drones.hpp"

#include <hive/name.hpp>

#include <algorithm>
#include <limits>

namespace hive {
namespace {

namespace fs = std::filesystem;

CrashedDrone read_crash(const event::Home& home, const std::string& drone)
{
    const auto object = home.read_crash(drone).value_or(Json::object());
    const Fields fields(object, "a crash");
    constexpr auto most = std::numeric_limits<std::int64_t>::max();
    return {.drone = drone,
            .pid = fields.integer("pid", 1, most),
            .time_us = fields.integer("time_us", 0, most),
            .signal = fields.text("signal"),
            .function = fields.text_or("function", ""),
            .source = fields.text_or("source", "")};
}

}  // namespace

std::vector<CrashedDrone> crashed_drones(const event::Home& home)
{
    std::vector<CrashedDrone> found;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(home.directory(), ignored)) {
        const auto name = entry.path().stem().string();
        if (entry.path().extension() != ".crash" || !entry.is_regular_file(ignored) || !is_name(name)
            || home.alive(name))
            continue;
        try {
            // A process that crashed before it had the name is not the drone that had it.
            if (auto crash = read_crash(home, name); crash.pid == home.holder(name))
                found.push_back(std::move(crash));
        } catch (const Error&) {
            // The disk was full when it was written, or it was edited by hand.
        }
    }
    std::ranges::sort(found, {}, &CrashedDrone::drone);
    return found;
}

}  // namespace hive
