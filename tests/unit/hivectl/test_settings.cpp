// Tests of key=value and of file endings.
#include "words/media_type.hpp"
#include "words/settings.hpp"

#include <hive/error.hpp>

#include <doctest/doctest.h>

using namespace hivectl;

namespace {

std::string refusal(const std::vector<std::string>& words)
{
    try {
        parse_settings(words);
    } catch (const hive::Error& error) {
        CHECK(error.code() == hive::Errc::invalid_argument);
        return error.what() + (error.advice().empty() ? "" : "; " + error.advice());
    }
    return {};
}

}  // namespace

TEST_CASE("settings: values stay texts, and only the first = separates")
{
    const auto settings = parse_settings({"scale=1.05", "text=a=b", "empty=", "shift=-3"});
    CHECK(settings == hive::Json{{"scale", "1.05"}, {"text", "a=b"}, {"empty", ""}, {"shift", "-3"}});
}

TEST_CASE("settings: a word without =, a key that is no name and a key given twice are refused")
{
    CHECK(refusal({"scale"}).find("\"scale\" is not key=value") != std::string::npos);
    CHECK(refusal({"=1"}).find("parameter name") != std::string::npos);
    CHECK(refusal({"a b=1"}).find("parameter name") != std::string::npos);
    CHECK(refusal({"scale=1", "scale=2"}) == "scale is given twice");
}

TEST_CASE("settings: one value is printed bare, several as key=value, those of many drones with the drone")
{
    CHECK(settings_text({{"scale", 1.05}}) == "1.05\n");
    CHECK(settings_text({{"path", "a b"}}) == "a b\n");
    CHECK(settings_text({{"min", 40}, {"on", true}}) == "min=40\non=true\n");
    CHECK(settings_text("face-1", {{"scale", 1.05}}) == "face-1 scale=1.05\n");
}

TEST_CASE("media type: endings are read without regard to case, and an unknown one says nothing")
{
    CHECK(media_type_of("a/b.JPG") == "image/jpeg");
    CHECK(media_type_of("b.json") == "application/json");
    CHECK(media_type_of("b.xyz").empty());
    CHECK(ending_fits("a.jpeg", "image/jpeg"));
    CHECK(ending_fits("a.txt", "text/plain; charset=utf-8"));
    CHECK(ending_fits("a", "image/png"));
    CHECK_FALSE(ending_fits("a.png", "image/jpeg"));
    for (const char* file : {"a.tiff", "a.gif", "a.webp", "a.mp4"})
        CHECK_FALSE(ending_fits(file, "image/png"));
}
