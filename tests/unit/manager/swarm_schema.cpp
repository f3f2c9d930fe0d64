// The schema, the reader and the table of files that both must accept or refuse.
#include "swarm_file/words.hpp"

#include <hive/connection_option.hpp>
#include <hive/swarm_plan.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

using namespace hive;

namespace {

Json table()
{
    std::ifstream file(HIVE_SWARM_TABLE);
    std::ostringstream text;
    text << file.rdbuf();
    return parse_json(text.str());
}

std::vector<std::string> sorted(std::span<const std::string_view> words)
{
    std::vector<std::string> result(words.begin(), words.end());
    std::ranges::sort(result);
    return result;
}

std::vector<std::string> keys_of(const Json& object)
{
    std::vector<std::string> keys;
    for (const auto& [key, value] : object.items())
        keys.push_back(key);
    return keys;  // nlohmann has them sorted
}

}  // namespace

TEST_CASE("swarm schema: the reader accepts and refuses the files of the table")
{
    const auto files = table();
    for (const auto& [name, file] : files.at("good").items()) {
        CAPTURE(name);
        const auto reading = read_swarm(to_text(file));
        for (const auto& mistake : reading.mistakes)
            FAIL_CHECK(mistake.at << ": " << mistake.text);
    }
    for (const auto& [name, file] : files.at("bad").items()) {
        CAPTURE(name);
        CHECK_FALSE(read_swarm(to_text(file)).mistakes.empty());
    }
}

TEST_CASE("swarm schema: it has every key that the reader knows, and no other")
{
    using namespace swarm_file;
    const auto schema = parse_json(swarm_schema());
    const auto& parts = schema.at("$defs");
    const auto& engines = parts.at("engine").at("properties");
    CHECK_EQ(keys_of(schema.at("properties")), sorted(file_keys));
    CHECK_EQ(keys_of(parts.at("drone").at("properties")), sorted(drone_keys()));
    CHECK_EQ(keys_of(parts.at("connection").at("properties")), sorted(connection_keys()));
    CHECK_EQ(keys_of(engines), sorted(engine_keys));
    CHECK_EQ(keys_of(engines.at("slurm").at("properties")), sorted(slurm_keys));
}

TEST_CASE("swarm schema: its words and bounds are those of the reader")
{
    using namespace swarm_file;
    const auto parts = parse_json(swarm_schema()).at("$defs");
    const auto& drone = parts.at("drone").at("properties");
    const auto& connection = parts.at("connection").at("properties");
    const auto itself = [](const Json& key) { return key.at("anyOf").at(0); };  // or a variable
    for (const auto& field : order_fields()) {
        CAPTURE(field.name);
        const auto& told = drone.at(field.name);
        if (field.type == OrderField::Type::flag)
            CHECK_EQ(told.at("default"), field.in_force({}));
        if (field.type == OrderField::Type::amount)
            CHECK_EQ(itself(told).at("maximum"), field.most);
        if (field.type != OrderField::Type::word)
            continue;
        CHECK(std::ranges::equal(itself(told).at("enum").get<std::vector<std::string>>(), field.words));
        CHECK_EQ(told.at("default"), field.usual);
    }
    CHECK_EQ(itself(drone.at("count")).at("maximum"), most_of_a_kind);
    CHECK_EQ(itself(connection.at("window")).at("maximum"), widest_window);
    CHECK_EQ(itself(connection.at("lease")).at("minimum"), shortest_lease_s);
    CHECK_EQ(itself(connection.at("lease")).at("maximum"), longest_lease_s);
}

TEST_CASE("swarm schema: every key has a title")
{
    const auto schema = parse_json(swarm_schema());
    const auto require_titles = [](const Json& properties) {
        for (const auto& [key, value] : properties.items()) {
            CAPTURE(key);
            CHECK(value.contains("title"));
        }
    };
    require_titles(schema.at("properties"));
    for (const char* part : {"drone", "connection", "engine"})
        require_titles(schema.at("$defs").at(part).at("properties"));
}
