// Zones and lines as users write them, and refusals.
#include <shapes.hpp>

#include <doctest/doctest.h>

#include <stdexcept>

using namespace zones;

namespace {

std::string refusal(std::vector<Shape> (*reader)(const std::string&), const std::string& text)
{
    try {
        static_cast<void>(reader(text));
        return "";
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("shapes: zones and lines are read, with any spaces and a last semicolon")
{
    const auto shapes = read_zones(" door: 0,0 0.5,0  0.5,1;\n shop-2 :0.5,.5 1,1 0.5,1; ");
    REQUIRE(shapes.size() == 2);
    CHECK(shapes[0] == Shape{"door", {{0, 0}, {0.5, 0}, {0.5, 1}}});
    CHECK(shapes[1].name == "shop-2");
    CHECK(shapes[1].points[0] == Point{0.5, 0.5});
    CHECK(read_zones("").empty());
    CHECK(read_lines("till: 0,0.5 1,0.5").at(0).points.size() == 2);
}

TEST_CASE("shapes: each mistake is refused with the name of the shape and the cause")
{
    CHECK(has(refusal(read_zones, "door: 0,0 1,1"), "door: 2 points; a zone needs at least 3"));
    CHECK(has(refusal(read_zones, "door: 0,0 320,0 1,1"), "\"320,0\" is outside 0 to 1"));
    CHECK(has(refusal(read_zones, "door: 0,0 1,-0.1 1,1"), "is outside 0 to 1"));
    CHECK(has(refusal(read_zones, "door: 0,0 nan,0 1,1"), "is outside 0 to 1"));
    CHECK(has(refusal(read_zones, "door: 0,0 a,b 1,1"), "\"a,b\" is not a point"));
    CHECK(has(refusal(read_zones, "door: 0,0 0.5 1,1"), "\"0.5\" is not a point"));
    CHECK(has(refusal(read_zones, "0,0 1,0 1,1"), "has no name"));
    CHECK(has(refusal(read_zones, "a b: 0,0 1,0 1,1"), "is not a name"));
    CHECK(has(refusal(read_zones, "door: 0,0 1,1 1,0 0,1"), "door: two of its sides cross"));
    CHECK(has(refusal(read_zones, "door: 0,0 1,0 1,1 0,0"), "door: the same point twice"));
    CHECK(has(refusal(read_zones, "door: 0,0 0.5,0.5 1,1"), "door: "));
    CHECK(has(refusal(read_zones, "a: 0,0 1,0 1,1; a: 0,0 1,0 1,1"), "a: duplicate name"));
    CHECK(has(refusal(read_lines, "till: 0,0"), "till: 1 points; a line needs 2"));
    CHECK(has(refusal(read_lines, "till: 0,0 0,0"), "till: no length"));
}

TEST_CASE("shapes: at most 16 of 32 points")
{
    std::string many, long_one = "a:";
    for (int i = 0; i < 17; ++i)
        many += "z" + std::to_string(i) + ": 0,0 1,0 1,1;";
    for (int i = 0; i < 33; ++i)
        long_one += " 0." + std::to_string(100 + i) + ",0";
    CHECK(has(refusal(read_zones, many), "more than 16"));
    CHECK(has(refusal(read_zones, long_one), "a: more than 32 points"));
}
