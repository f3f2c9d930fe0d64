// What a recording around an event waits for.
#include "condition.hpp"

#include <doctest/doctest.h>

#include <stdexcept>

using nlohmann::json;
using record::Condition;

namespace {

bool holds(const char* text, const json& header) { return Condition(text).holds(header); }

}  // namespace

TEST_CASE("condition: a field alone, compared with a number or a text, and several")
{
    const json header{{"event", "enter"}, {"count", 3}, {"alarm", false}, {"zone", {{"name", "door"}, {"dwell", 2.5}}}};
    for (const char* text :
         {"*", " * ", "event", "count", "event=enter", "event==enter", "count>2", "count >= 3", "count!=4",
          "zone.name=door", "zone.dwell<3", "event=enter, count=3", "alarm=false", "event>ends"})
        CHECK_MESSAGE(holds(text, header), std::string(text));
    for (const char* text : {"alarm", "nothing", "event=leave", "count>3", "count<3", "zone.name!=door",
                             "event=enter,count=4", "zone.none=1", "event.name=enter", "zone.name.x"})
        CHECK_FALSE_MESSAGE(holds(text, header), std::string(text));
}

TEST_CASE("condition: an array counts as its length, and a path leads to each of its elements")
{
    const json header{{"faces", {{{"score", 0.5}, {"name", "a"}}, {{"score", 0.9}, {"name", "b"}}}},
                      {"hands", json::array()}};
    for (const char* text : {"faces", "faces>0", "faces=2", "faces.score>0.8", "faces.name=a", "hands=0"})
        CHECK_MESSAGE(holds(text, header), std::string(text));
    for (const char* text : {"hands", "faces>2", "faces.score>0.9", "hands.score>0", "faces.none"})
        CHECK_FALSE_MESSAGE(holds(text, header), std::string(text));
}

TEST_CASE("condition: an invalid one is refused")
{
    for (const char* text : {"", " ", "=3", "count=", "count=>3", "count<>3", "a..b", ".a", "a,", "a,=2", "!a"})
        CHECK_THROWS_AS_MESSAGE(holds(text, {}), std::invalid_argument, std::string(text));
}
