#include "regular_file.hpp"

#include <stdexcept>

namespace writing {

void require_regular_or_missing(const std::filesystem::path& path)
{
    std::error_code unknown;  // the following open reports an inaccessible path
    const auto status = std::filesystem::status(path, unknown);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw std::runtime_error(path.string() + " is not a regular file");
}

}  // namespace writing
