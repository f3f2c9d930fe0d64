// hivectl devices: lists the V4L2 cameras of this machine, with formats, sizes and rates.
#include "../verbs.hpp"
#include "words/video_device.hpp"

#include <hive/error.hpp>
#include <hive/platform/descriptor.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/ioctl.h>

namespace hivectl::devices_verb {
namespace {

namespace fs = std::filesystem;

/// /dev/video0, /dev/video1, ... in the order of their numbers.
std::vector<std::string> paths()
{
    std::vector<std::string> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator("/dev", none))
        if (entry.path().filename().string().starts_with("video"))
            found.push_back(entry.path().string());
    std::ranges::sort(found, {}, [](const std::string& path) { return std::pair(path.size(), path); });
    return found;
}

void add_rows(std::vector<Row>& rows, const std::string& path)
{
    const hive::platform::Descriptor opened(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    if (!opened)
        throw hive::Error(hive::Errc::refused, "cannot use " + path + ": " + std::strerror(errno),
                          errno == EACCES ? "join the video group: adduser NAME video" : "");
    const auto device =
        video_device([&](unsigned long request, void* about) { return ::ioctl(opened.get(), request, about) == 0; });
    if (!device)
        return;
    for (const auto& mode : device->modes)
        rows.push_back({{"device", path},
                        {"name", device->name},
                        {"driver", device->driver},
                        {"format", mode.format},
                        {"size", mode.size},
                        {"fps", mode.rates}});
}

std::string as_rates(const hive::Json& rates) { return rates_text(rates.get<std::vector<double>>()); }

int run(Session& session)
{
    Outcome outcome("devices");
    std::vector<Row> rows;
    for (const auto& path : paths())
        outcome.request(path, [&] { add_rows(rows, path); });
    print_rows(session.form(),
               {{"DEVICE", "device"},
                {"NAME", "name"},
                {"DRIVER", "driver"},
                {"FORMAT", "format"},
                {"SIZE", "size"},
                {"FPS", "fps", as_rates}},
               rows);
    if (rows.empty() && outcome.exit_code() == exit_code::done)
        complain("devices", "no V4L2 camera on this machine");
    return outcome.exit_code();
}

}  // namespace

Verb verb()
{
    return {.name = "devices",
            .group = "run drones",
            .usage = "[options]",
            .summary = "Lists the V4L2 cameras of this machine and their formats",
            .details = "One line per format and size, with the supported frame rates. To choose: hivectl set camera "
                       "source=DEVICE format=MJPG width=1280 height=720 fps=30.",
            .examples = "hivectl devices",
            .table = true,
            .declare = [](CommandLine&, Session& session) { return [&session] { return run(session); }; }};
}

}  // namespace hivectl::devices_verb
