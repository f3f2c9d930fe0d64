// The examples on the drones' pages, to be compared with the drones' events.
#pragma once

#include <nlohmann/json.hpp>

#include <fstream>
#include <string>
#include <vector>

namespace hive::test {

/// The first block marked `json` on a drone's page.
inline nlohmann::json json_example(const std::string& drone)
{
    std::ifstream page(std::string(HIVE_SOURCE_DIR) + "/drones/" + drone + "/README.md");
    std::string line, block;
    while (std::getline(page, line) && line != "```json") {
    }
    while (std::getline(page, line) && line != "```")
        block += line + "\n";
    return nlohmann::json::parse(block);
}

inline std::vector<std::string> keys(const nlohmann::json& object)
{
    std::vector<std::string> names;
    for (const auto& [name, value] : object.items())
        names.push_back(name);
    return names;
}

/// Of the header of a result: without the file metadata of its image.
inline std::vector<std::string> own_keys(nlohmann::json header)
{
    for (const char* field : {"file", "fps", "media_time_us"})
        header.erase(field);
    return keys(header);
}

}  // namespace hive::test
