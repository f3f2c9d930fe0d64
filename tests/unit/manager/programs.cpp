// Tests of finding the programs of drones.
#include "programs_for_tests.hpp"

#include <hive/error.hpp>
#include <hive/program.hpp>
#include <hive/remote.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>

using namespace std::chrono_literals;

TEST_CASE("programs: hive-KIND is the program of a drone")
{
    const Programs programs({"hive-toy", "beehive-toy"});
    const auto kinds = hive::kinds();
    CHECK(std::ranges::count(kinds, "toy") == 1);
    CHECK(std::ranges::count(kinds, "beehive-toy") == 0);
    CHECK(hive::program_of("toy"));
    CHECK_FALSE(hive::program_of("toys"));
}

TEST_CASE("programs: a directory may name kinds that can be started and are not offered")
{
    const Programs programs({"hive-toy", "hive-trial"});
    std::ofstream(std::filesystem::path(std::getenv("HIVE_DRONE_PATH")) / ".hive-unlisted") << "trial\nother\n";
    const auto kinds = hive::kinds();
    CHECK(std::ranges::count(kinds, "toy") == 1);
    CHECK(std::ranges::count(kinds, "trial") == 0);
    CHECK(hive::program_of("trial"));
}

TEST_CASE("programs: the connection of ssh is kept in the home, as ssh's own syntax writes it, where it fits")
{
    const auto path_in = [](const char* home) {
        const auto words = hive::Remote("far", home).command({"ps"});
        const auto found = std::ranges::find_if(words, [](const auto& word) { return word.starts_with("-oControlP"); });
        const auto path =
            std::ranges::find_if(words, [](const auto& word) { return word.starts_with("-oControlPath="); });
        CHECK((found == words.end()) == (path == words.end()));  // without a place none is kept either
        return path == words.end() ? std::string() : *path;
    };
    CHECK(path_in("/run/hive") == "-oControlPath=\"/run/hive/.ssh-%C\"");
    CHECK(path_in("/tmp/a b") == "-oControlPath=\"/tmp/a b/.ssh-%C\"");
    CHECK(path_in("/home/50%off") == "-oControlPath=\"/home/50%%off/.ssh-%C\"");
    CHECK(path_in("/tmp/a\"b").empty());
    CHECK(path_in(("/tmp/" + std::string(60, 'x')).c_str()).empty());
}

TEST_CASE("programs: a kind is asked for its interface")
{
    const Programs programs({"hive-toy"}, "#!/bin/sh\n"
                                          "[ \"$1\" = --describe ] || exit 1\n"
                                          "echo '{\"kind\": \"toy\", \"version\": \"1\", \"summary\": \"A toy.\","
                                          " \"inputs\": [{\"name\": \"image\", \"type\": \"image/*\"}],"
                                          " \"outputs\": [], \"parameters\": []}'\n");
    const auto interface = hive::interface_of("toy");
    CHECK(interface.kind == "toy");
    REQUIRE(interface.inputs.size() == 1);
    CHECK(interface.inputs[0].type == "image/*");
    CHECK_THROWS_WITH_AS(hive::interface_of("toys"), doctest::Contains("there is no drone hive-toys"), hive::Error);
}

TEST_CASE("programs: one that does not tell its interface is an error, and one that says nothing is not waited for")
{
    {
        const Programs programs({"hive-toy"}, "#!/bin/sh\necho 'no such camera' >&2\nexit 3\n");
        CHECK_THROWS_WITH_AS(hive::interface_of("toy"), doctest::Contains("exit code 3: no such camera"), hive::Error);
    }
    {
        const Programs programs({"hive-toy"}, "#!/bin/sh\necho Hello\n");
        CHECK_THROWS_WITH_AS(hive::interface_of("toy"), doctest::Contains("does not print an interface"), hive::Error);
    }
    const Programs programs({"hive-toy"}, "#!/bin/sh\nexec sleep 60\n");
    CHECK_THROWS_WITH_AS(hive::interface_of("toy", 50ms), doctest::Contains("has not answered in time"), hive::Error);
}
