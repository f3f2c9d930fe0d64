// One small file for each, NAME.crash, which the dying process wrote.
#include "crashed_drones.hpp"

#include <hive/name.hpp>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

namespace hive {
namespace {

namespace fs = std::filesystem;

constexpr JsonLimits crash_limits{.bytes = 8 * 1024, .depth = 2, .keys = 8, .string_bytes = 2 * 1024};

CrashedDrone read_crash(const fs::path& file)
{
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    const auto object = parse_json(text.str(), crash_limits);
    const Fields fields(object, "a crash");
    constexpr auto most = std::numeric_limits<std::int64_t>::max();
    return {.drone = file.stem().string(),
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
            // One that crashed before it had the name says nothing of the one that had it.
            if (auto crash = read_crash(entry.path()); crash.pid == home.holder(name))
                found.push_back(std::move(crash));
        } catch (const Error&) {
            // The disk was full when it was written, or somebody has changed it by hand.
        }
    }
    std::ranges::sort(found, {}, &CrashedDrone::drone);
    return found;
}

}  // namespace hive
