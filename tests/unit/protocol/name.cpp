// Globs at their edges, edit distance, "did you mean".
#include <hive/error.hpp>
#include <hive/name.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace hive;

TEST_CASE("name: the error says what was given and what a name is, safely")
{
    CHECK_THROWS_WITH_AS(require_name("a\x1b[31m", "drone"),
                         "\"a\\u001b[31m\" is not a drone name: 1 to 64 letters, digits, '_', '.' or '-', starting "
                         "with a letter or digit",
                         Error);
    CHECK_EQ(require_name("face-1", "drone"), "face-1");
}

TEST_CASE("name: a port has no point, so what is a port of which drone is certain")
{
    CHECK(belongs_to("cam.1.image", "cam.1"));
    CHECK_FALSE(belongs_to("cam.1.image", "cam"));
    CHECK(belongs_to("cam.image", "cam"));
    CHECK_FALSE(belongs_to("camera.image", "cam"));
    CHECK(belongs_to("cam", "cam"));
    CHECK_FALSE(belongs_to("cam.1", "cam.1.image"));
    CHECK_FALSE(belongs_to("cam.", "cam"));
    CHECK_EQ(require_port_name("image", "output"), "image");
    CHECK_THROWS_WITH_AS(require_port_name("im.age", "output"),
                         "\"im.age\" is not the name of an output, because it has a point", Error);
}

TEST_CASE("glob: hostile patterns do not take exponential time")
{
    std::string pattern;
    for (int i = 0; i < 500; ++i)
        pattern += "*a";
    CHECK_FALSE(matches_glob(pattern + "b", std::string(1000, 'a')));
    CHECK(matches_glob(pattern, std::string(1000, 'a')));
}

TEST_CASE("edit distance: insertions, deletions, substitutions count one each")
{
    CHECK_EQ(edit_distance("", ""), 0u);
    CHECK_EQ(edit_distance("", "abc"), 3u);
    CHECK_EQ(edit_distance("abc", ""), 3u);
    CHECK_EQ(edit_distance("camera", "camera"), 0u);
    CHECK_EQ(edit_distance("camera", "camra"), 1u);
    CHECK_EQ(edit_distance("camera", "camela"), 1u);
    CHECK_EQ(edit_distance("camera", "cameras"), 1u);
    CHECK_EQ(edit_distance("kitten", "sitting"), 3u);
    CHECK_EQ(edit_distance("sitting", "kitten"), 3u);
}

TEST_CASE("nearest: the most similar candidate, or none when nothing is like it")
{
    const std::vector<std::string> drones{"camera", "face", "scale"};
    CHECK_EQ(nearest("camra", drones), "camera");
    CHECK_EQ(nearest("fac", drones), "face");
    CHECK_EQ(nearest("Scale", drones), "scale");
    CHECK_EQ(nearest("zzzzzz", drones), "");
    CHECK_EQ(nearest("", drones), "");
    CHECK_EQ(nearest("camera", std::vector<std::string>{}), "");
}

TEST_CASE("nearest: the first of equals wins")
{
    CHECK_EQ(nearest("face-3", std::vector<std::string>{"face-1", "face-2"}), "face-1");
}
