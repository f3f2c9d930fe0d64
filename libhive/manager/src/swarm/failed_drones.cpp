// Keeps one small file per drone.
#include "failed_drones.hpp"

#include <hive/event/home.hpp>
#include <hive/process.hpp>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace hive::swarm {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view failed_ending = ".failed";
constexpr std::size_t log_lines = 5;
constexpr JsonLimits file_limits{.bytes = 64 * 1024, .depth = 2, .keys = 8, .string_bytes = 16 * 1024};

}  // namespace

void FailedDrones::add(FailedDrone failed) const
{
    if (failed.log.empty())
        failed.log = last_lines(home_ / (failed.drone + ".log"), log_lines);
    event::replace_file(file(failed.drone), to_text(Json{{"reason", failed.reason}, {"log", failed.log}}));
}

bool FailedDrones::forget(const std::string& drone) const
{
    std::error_code ignored;
    return fs::remove(file(drone), ignored);
}

std::vector<FailedDrone> FailedDrones::all() const
{
    std::vector<FailedDrone> found;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(home_, ignored))
        if (entry.path().extension() == failed_ending)
            try {
                std::ostringstream text;
                text << std::ifstream(entry.path()).rdbuf();
                const auto object = parse_json(text.str(), file_limits);
                const Fields fields(object, "a failed drone");
                found.push_back({entry.path().stem().string(), fields.text("reason"), fields.text_or("log", "")});
            } catch (const Error&) {
                // It is being written, or was edited by hand.
            }
    std::ranges::sort(found, {}, &FailedDrone::drone);
    return found;
}

}  // namespace hive::swarm
