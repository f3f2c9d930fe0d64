// Paths are the values of parameters that affect the drone's machine.
#include "needs.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

namespace hive {
namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& text)
{
    std::error_code ignored;
    const auto begins = [&](const char* with) { return text.starts_with(with); };
    return begins("/") || begins("./") || begins("../") || begins("~/") || fs::is_regular_file(text, ignored);
}

/// A kind that is not installed here is unknown.
std::optional<Interface> known(const std::string& kind, const InterfaceOfKind& interface_of)
try {
    return interface_of ? std::optional(interface_of(kind)) : std::nullopt;
} catch (const Error&) {
    return std::nullopt;
}

}  // namespace

std::map<std::string, Needs> needs_of(const SwarmPlan& plan, const InterfaceOfKind& interface_of)
{
    std::map<std::string, std::optional<Interface>> kinds;
    std::map<std::string, Needs> all;
    for (const auto& drone : plan.drones) {
        auto& needs = all[drone.name];
        for (const auto& [name, value] : drone.set.items()) {
            const auto text = value.is_string() ? value.get<std::string>() : "";
            if (!is_file(text))
                continue;
            if (!kinds.contains(drone.kind))
                kinds[drone.kind] = known(drone.kind, interface_of);
            const auto& interface = kinds[drone.kind];
            const auto* parameter = interface ? interface->parameter(name) : nullptr;
            if (parameter && !parameter->for_operator)
                continue;
            needs.files.insert(text);
            if (text.starts_with("/dev/") && text.find(':') == text.npos)
                needs.devices.insert(text);
            if (auto folder = folder_of(text); !folder.empty())
                needs.folders.insert(std::move(folder));
        }
    }
    return all;
}

std::string folder_of(const std::string& path)
{
    static const std::set<std::string> of_system{"",      "bin",   "boot",   "dev", "etc",  "lib",
                                                 "lib32", "lib64", "libx32", "opt", "proc", "root",
                                                 "run",   "sbin",  "sys",    "tmp", "usr",  "var"};
    const fs::path folder = fs::path(path).parent_path(), inner = folder.relative_path();
    const auto top = inner.empty() ? std::string() : inner.begin()->string();
    if (!path.starts_with("/") || path.find(':') != path.npos || std::ranges::find(folder, "..") != folder.end()
        || of_system.contains(top) || inner == "home")
        return {};
    return folder.string();
}

}  // namespace hive
