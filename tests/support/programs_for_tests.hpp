// Fake drone programs in the search path.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

class Programs {
public:
    explicit Programs(const std::vector<std::string>& names, const std::string& script = "\n")
    {
        std::string directory = (std::filesystem::temp_directory_path() / "hive-programs-XXXXXX").string();
        directory_ = ::mkdtemp(directory.data());
        for (const auto& name : names) {
            std::ofstream(directory_ / name) << script;
            std::filesystem::permissions(directory_ / name, std::filesystem::perms::owner_all);
        }
        ::setenv("HIVE_DRONE_PATH", directory_.c_str(), 1);
    }
    ~Programs()
    {
        ::unsetenv("HIVE_DRONE_PATH");
        std::filesystem::remove_all(directory_);
    }
    Programs(const Programs&) = delete;
    Programs& operator=(const Programs&) = delete;

private:
    std::filesystem::path directory_;
};
