// Reads /proc/self/cgroup, and /sys/fs/cgroup where every system of today mounts the groups.
#include "control_group.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace hive::platform {
namespace {

namespace fs = std::filesystem;

/// The names of the files of one version.
struct Files {
    const char *limit, *usage, *reclaimable;
};
constexpr Files version1{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};
constexpr Files version2{"memory.max", "memory.current", "inactive_file"};

struct Group {
    fs::path mount, path;  ///< the path below the mount
    const Files& files;
};

std::vector<Group> own_groups()
{
    const fs::path mount("/sys/fs/cgroup");
    std::error_code ignored;
    const bool mixed = fs::exists(mount / "unified", ignored);
    std::vector<Group> groups;
    std::ifstream file("/proc/self/cgroup");
    for (std::string line; std::getline(file, line);) {  // "4:memory,hugetlb:/docker/1f" or "0::/user.slice"
        const auto first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos)
            continue;
        const auto controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        const auto path = fs::path(line.substr(second + 1)).relative_path();
        if (controllers == ",,")
            groups.push_back({mixed ? mount / "unified" : mount, path, version2});
        else if (controllers.find(",memory,") != std::string::npos)
            groups.push_back({mount / "memory", path, version1});
    }
    return groups;
}

/// Nothing: no such file, or "max".
std::optional<std::int64_t> number_in(const fs::path& file)
{
    std::ifstream in(file);
    std::int64_t number = 0;
    return in >> number ? std::optional(number) : std::nullopt;
}

/// The kernel drops cached files before it kills a process.
std::int64_t reclaimable(const fs::path& directory, const std::string& key)
{
    std::ifstream in(directory / "memory.stat");
    std::int64_t number = 0;
    for (std::string name; in >> name >> number;)
        if (name == key)
            return number;
    return 0;
}

void add(std::optional<GroupMemory>& memory, const fs::path& directory, const Files& files)
{
    constexpr std::int64_t unlimited = std::int64_t{1} << 60;  // version 1 has a number for "no limit"
    const auto limit = number_in(directory / files.limit);
    const auto usage = limit && *limit < unlimited ? number_in(directory / files.usage) : std::nullopt;
    if (!usage)
        return;
    const auto used = std::max<std::int64_t>(0, *usage - reclaimable(directory, files.reclaimable));
    const auto left = std::max<std::int64_t>(0, *limit - used);
    if (!memory || left < memory->available)
        memory = GroupMemory{*limit, left};
}

}  // namespace

std::optional<GroupMemory> group_memory()
{
    std::optional<GroupMemory> memory;
    for (const auto& group : own_groups())
        for (auto path = group.path;; path = path.parent_path()) {
            add(memory, group.mount / path,
                group.files);  // in a container the path may be the host's: only the mount exists
            if (path.empty())
                break;
        }
    return memory;
}

}  // namespace hive::platform
