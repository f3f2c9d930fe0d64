// Looking for hive-KIND in the directories.
#include "programs.hpp"

#include <cstdlib>
#include <set>
#include <sstream>
#include <unistd.h>

namespace hivectl {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view prefix = "hive-";

/// hive-X-emulator is a device for trials beside the drone of that device, and no drone. Others are not asked: running
/// what is merely called hive-something would be rash.
bool is_emulator(std::string_view kind) { return kind.ends_with("-emulator"); }

bool is_program(const fs::path& file)
{
    std::error_code ignored;
    return fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0;
}

std::vector<fs::path> directories()
{
    std::error_code ignored;
    std::vector<fs::path> result;
    if (const auto self = fs::read_symlink("/proc/self/exe", ignored); !self.empty())
        result.push_back(self.parent_path());
    for (const char* variable : {"HIVE_DRONE_PATH", "PATH"})
        if (const char* value = std::getenv(variable)) {
            std::istringstream list(value);
            for (std::string directory; std::getline(list, directory, ':');)
                if (!directory.empty())
                    result.push_back(fs::absolute(directory));
        }
    return result;
}

}  // namespace

std::optional<fs::path> program_of(const std::string& kind)
{
    if (is_emulator(kind))
        return std::nullopt;
    for (const auto& directory : directories())
        if (const auto file = directory / (std::string(prefix) + kind); is_program(file))
            return file;
    return std::nullopt;
}

std::vector<std::string> kinds()
{
    std::set<std::string> found;
    std::error_code ignored;
    for (const auto& directory : directories())
        for (const auto& entry : fs::directory_iterator(directory, ignored))
            if (const auto name = entry.path().filename().string();
                name.starts_with(prefix) && !is_emulator(name) && is_program(entry.path()))
                found.insert(name.substr(prefix.size()));
    return {found.begin(), found.end()};
}

}  // namespace hivectl
