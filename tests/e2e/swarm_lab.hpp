// Machines reachable over ssh, and a swarm file for them.
#pragma once

#include "lab.hpp"
#include "measure.hpp"

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

namespace hive::test {

/// A number from the environment, for longer runs by hand.
inline int number_from(const char* variable, int otherwise)
{
    const char* const text = std::getenv(variable);
    return text ? std::stoi(text) : otherwise;
}

/// A laptop and machines, with one key, and a swarm file. One is reached as USER@HOST, the others by their own names.
class Machines {
public:
    explicit Machines(const Json& content, const std::vector<std::string>& names = {"cam1", "gpu1", "gpu2"})
        : lab(names), count_(names.size())
    {
        lab.share_key();
        write(content);
    }
    void write(Json content) const
    {
        content["engines"]["cam1"]["ssh"] = "root@cam1";
        std::ofstream(file()) << content.dump(2);
    }
    [[nodiscard]] std::filesystem::path file() const { return lab.directory() / "work.json"; }
    [[nodiscard]] std::string up() const { return lab.hivectl_done("up ~/work.json"); }
    /// Processes of drones on all machines, whether they answer or not.
    [[nodiscard]] std::size_t processes() const
    {
        std::size_t count = 0;
        std::error_code ignored;
        for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
            const auto command = text_of(entry.path() / "cmdline"),
                       variables = text_of(entry.path() / "environ") + '\0';
            if (!has(command.substr(0, command.find('\0')), "/hive-"))
                continue;
            for (std::size_t i = 0; i < count_; ++i)
                count += has(variables, "HIVE_HOME=" + lab.machine(i).swarm.home().string() + '\0') ? 1 : 0;
        }
        return count;
    }
    [[nodiscard]] std::map<std::string, std::int64_t> pids() const
    {
        std::map<std::string, std::int64_t> found;
        for (const auto& row : Json::parse(lab.hivectl_done("ps --json --timeout 10")))
            if (row.at("pid").is_number())
                found[row.at("name")] = row.at("pid");
        return found;
    }

    Lab lab;

private:
    std::size_t count_;
};

}  // namespace hive::test
