// A temporary directory that only this user can enter.
#pragma once

#include "child.hpp"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace hive {

/// Removed with its content.
class OwnDirectory {
public:
    OwnDirectory()
    {
        auto pattern = (std::filesystem::temp_directory_path() / "hive-rerun-XXXXXX").string();
        require_done(::mkdtemp(pattern.data()) ? 0 : errno, "make a temporary directory");
        path_ = pattern;
    }
    ~OwnDirectory()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    OwnDirectory(const OwnDirectory&) = delete;
    OwnDirectory& operator=(const OwnDirectory&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace hive
