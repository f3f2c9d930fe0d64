// The examples on the pages of the drones: they match what the code writes and reads.
#include "../../../drones/track/boxes.hpp"

#include <colours.hpp>
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <set>

using hive::Json;

namespace {

/// The blocks of a page between ```json and ```.
std::vector<Json> examples(const std::string& page)
{
    std::vector<Json> found;
    std::ifstream in(std::filesystem::path(HIVE_SOURCE_DIR) / page);
    std::string block;
    bool inside = false;
    for (std::string line; std::getline(in, line);)
        if (inside && line == "```") {
            found.push_back(hive::parse_json(block));
            inside = false;
        } else if (inside) {
            block += line;
        } else if (line == "```json") {
            block.clear();
            inside = true;
        }
    return found;
}

std::set<std::string> keys_of(const Json& object)
{
    std::set<std::string> keys;
    for (const auto& [key, value] : object.items())
        keys.insert(key);
    return keys;
}

}  // namespace

TEST_CASE("pages: the tracker reads the boxes that the page of background shows")
{
    const auto shown = examples("drones/background/README.md");
    REQUIRE(shown.size() == 2);
    const auto boxes = track::boxes_in(shown[0], "");
    REQUIRE(boxes.size() == 1);
    CHECK(boxes[0].x == 213);
    CHECK(boxes[0].h == 148);
    CHECK(boxes[0].look.size() == static_cast<std::size_t>(colours::numbers));
}

TEST_CASE("pages: the page of track shows exactly the fields of a track")
{
    const auto shown = examples("drones/track/README.md");
    REQUIRE(shown.size() == 1);
    REQUIRE(shown[0].at("tracks").size() == 1);
    CHECK(keys_of(shown[0].at("tracks")[0]) == keys_of(track::to_json({track::Track{}})[0]));
}
