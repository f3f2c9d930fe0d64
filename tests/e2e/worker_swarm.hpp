// A swarm of a source, workers that share its events and a sink, as a file; and queries of its running drones.
#pragma once

#include "measure.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

namespace hive::test {

/// HIVE_TEST_SEED replays a random test.
inline std::uint64_t seed_of_test()
{
    const char* const told = std::getenv("HIVE_TEST_SEED");
    return told ? std::stoull(told) : std::random_device{}();
}

/// A source on demand, this many workers that share it, and a counter of their results.
inline hive::Json workers_file(int workers)
{
    return {{"swarm", "work"},
            {"drones",
             {{"source", {{"kind", "ticker"}, {"set", {{"fps", 50}, {"bytes", 100}}}}},
              {"worker", {{"kind", "sleeper"}, {"count", workers}, {"set", {{"work_ms", 1}}}}},
              {"sink", {{"kind", "sleeper"}}}}},
            {"connections",
             {{{"from", "source"}, {"to", "worker-*"}, {"share", true}, {"window", 2}},
              {{"from", "worker-*"}, {"to", "sink"}, {"stream", true}}}}};
}

/// A swarm's file, in the home of its swarm.
class File {
public:
    File(const Swarm& swarm, const hive::Json& content) : path_((swarm.home() / "swarm.json").string())
    {
        write(content);
    }
    void write(const hive::Json& content) const { std::ofstream(path_) << content.dump(2); }
    operator std::string() const { return path_; }

private:
    std::string path_;
};

/// The steps that `up` reports, one per line.
inline std::vector<std::string> steps(const Swarm& swarm, const File& file)
{
    std::istringstream lines(swarm.hivectl_done({"up", file}, std::chrono::seconds(60)));
    std::vector<std::string> steps;
    for (std::string line; std::getline(lines, line);)
        steps.push_back(line);
    return steps;
}

/// Process ids by name.
inline std::map<std::string, std::int64_t> running(const Swarm& swarm)
{
    std::map<std::string, std::int64_t> pids;
    for (const auto& row : hive::Json::parse(swarm.hivectl_done({"ps", "--json", "--timeout", "10"})))
        pids[row.at("name")] = row.at("pid").is_null() ? -1 : row.at("pid").get<std::int64_t>();
    return pids;
}

/// Processes of drones whose home this is, whether they answer or not.
inline std::size_t count_processes(const Swarm& swarm)
{
    std::size_t count = 0;
    const std::string mine = "HIVE_HOME=" + swarm.home().string();
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
        const auto command = text_of(entry.path() / "cmdline");
        if (has(command.substr(0, command.find('\0')), "/hive-")
            && has(text_of(entry.path() / "environ") + '\0', mine + '\0'))
            ++count;
    }
    return count;
}

/// A drone may exit shortly after it has released its name.
inline bool has_processes(const Swarm& swarm, std::size_t count)
{
    return eventually([&] { return count_processes(swarm) == count; });
}

/// The number of connections known to both ends.
inline std::int64_t edges(const Swarm& swarm)
{
    std::int64_t connected = 0;
    for (const auto& row : hive::Json::parse(swarm.hivectl_done({"connections", "--json", "--timeout", "10"})))
        connected += row.at("state") == "connected" && row.at("known_by") == "both";
    return connected;
}

}  // namespace hive::test
