// The file system's own writes.
#include <hive/platform/files.hpp>

#include <fstream>

namespace hive::platform {

bool write_private(const std::filesystem::path& file, const std::string& text)
{
    std::ofstream stream(file, std::ios::trunc);
    std::error_code ignored;  // the folder is for its owner only, too
    std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write,
                                 ignored);
    stream << text;
    return !stream.flush().fail();
}

std::error_code rename(const std::filesystem::path& from, const std::filesystem::path& to)
{
    std::error_code problem;
    std::filesystem::rename(from, to, problem);
    return problem;
}

}  // namespace hive::platform
