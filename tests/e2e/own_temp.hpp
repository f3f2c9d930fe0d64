// Kept failures, and the temporary directories of the drones that take them again.
#pragma once

#include "swarm.hpp"

#include <cstdlib>
#include <doctest/doctest.h>

namespace hive::test {

/// Once there is one.
inline std::vector<KeptFailure> failures(Application& application, const std::string& drone)
{
    std::vector<KeptFailure> found;
    REQUIRE(eventually([&] { return !(found = application.failures(drone, true)).empty(); }));
    return found;
}

/// The folder for homes of fresh drones, for the programs that a test starts.
class OwnTemp {
public:
    explicit OwnTemp(const Swarm& swarm) : path_(swarm.home() / "tmp")
    {
        std::filesystem::create_directory(path_);
        ::setenv("TMPDIR", path_.c_str(), 1);
    }
    ~OwnTemp() { ::unsetenv("TMPDIR"); }
    OwnTemp(const OwnTemp&) = delete;
    OwnTemp& operator=(const OwnTemp&) = delete;
    [[nodiscard]] bool empty() const { return std::filesystem::is_empty(path_); }
    /// Of the only fresh drone, once it has a socket of this name.
    [[nodiscard]] std::filesystem::path home(const std::string& socket) const
    {
        for (const auto& entry : std::filesystem::directory_iterator(path_))
            if (std::filesystem::exists(entry.path() / socket))
                return entry.path();
        return {};
    }

private:
    std::filesystem::path path_;
};

}  // namespace hive::test
