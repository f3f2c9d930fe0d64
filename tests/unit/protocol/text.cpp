// Printing: valid UTF-8 always, and nothing that a terminal obeys.
#include <hive/error.hpp>
#include <hive/json.hpp>
#include <hive/json_places.hpp>
#include <hive/printable.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <set>

using namespace hive;

TEST_CASE("text: a value is written as nlohmann's dump writes it")
{
    Json value =
        parse_json(R"({"":null,"a\"b":[[],[[]],{},[{}],[1,[2]]],"flag":[true,false],"number":[0,-1,1.5,1e300]})");
    value["text"] = {"", "plain ~", "a\"b\\c", "\x7F", "line\n", "gr\u00FC\u00DF", "\xFF", std::string("nul\0", 4)};
    value["\xC3"] = {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::uint64_t>::max()};
    CHECK_EQ(to_text(value), value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

TEST_CASE("text: bytes that are not UTF-8 become U+FFFD instead of an exception")
{
    CHECK_EQ(to_text(Json("a\xff"
                          "b")),
             "\"a\xEF\xBF\xBD"
             "b\"");
    CHECK_NOTHROW(parse_json(to_text(Json{{"\xc3", "\xf0\x9f"}})));
}

TEST_CASE("text: numbers that JSON does not have become null")
{
    CHECK_EQ(to_text(Json(std::numeric_limits<double>::infinity())), "null");
    CHECK_EQ(to_text(Json(std::nan(""))), "null");
}

TEST_CASE("quotes: control characters of C0, DEL and C1 are escaped, letters are not")
{
    CHECK_EQ(in_quotes("a\x1b[31m\n\"\\"), "\"a\\u001b[31m\\n\\\"\\\\\"");
    CHECK_EQ(in_quotes("a\x7f"), "\"a\\u007f\"");
    CHECK_EQ(in_quotes("\xc2\x9b"
                       "31m \xc2\x80 \xc2\x9f"),
             "\"\\u009b31m \\u0080 \\u009f\"");
    CHECK_EQ(in_quotes("Gr\xc3\xb6\xc3\x9f"
                       "e \xc2\xa0"),
             "\"Gr\xc3\xb6\xc3\x9f"
             "e \xc2\xa0\"");
}

TEST_CASE("quotes: no byte that a terminal obeys comes out, whatever goes in")
{
    for (int first = 0; first < 256; ++first)
        for (int second = 0; second < 256; ++second) {
            const std::string quoted = in_quotes(std::string{static_cast<char>(first), static_cast<char>(second)});
            for (std::size_t i = 0; i < quoted.size(); ++i) {
                const auto byte = static_cast<unsigned char>(quoted[i]);
                const bool c1 = byte == 0xc2 && static_cast<unsigned char>(quoted[i + 1]) < 0xa0;
                if (byte < 0x20 || byte == 0x7f || c1)
                    FAIL("control character from bytes " << first << " " << second);
            }
        }
}

TEST_CASE("quotes: what they hold is the text again")
{
    CHECK_EQ(parse_json(in_quotes("\x7f\xc2\x9b\\u0041\t")), Json("\x7f\xc2\x9b\\u0041\t"));
    CHECK_LE(in_quotes(std::string(100'000, 'a')).size(), 210u);
}

TEST_CASE("texts: what is shortened is no longer than asked, whole characters, and stays when it is shortened again")
{
    CHECK_EQ(shortened("short"), "short");
    const std::string text = "x" + std::string(3000, 'y');
    std::string bees = "z";
    for (int i = 0; i < 2000; ++i)
        bees += "\xF0\x9F\x90\x9D";
    for (const auto& longer : {text + text, bees, std::string(9000, '\x80')})
        for (std::size_t most = 4000; most < 4004; ++most) {
            const auto cut = shortened(longer, most);
            CHECK_LE(cut.size(), most);
            CHECK(cut.ends_with("\xE2\x80\xA6"));
            CHECK_EQ(shortened(cut, most), cut);
        }
    CHECK_EQ(parse_json(to_text(Json(shortened(bees)))).get<std::string>(), shortened(bees));  // still UTF-8
}

TEST_CASE("JSON: no more values than the limit, wherever they are")
{
    JsonLimits limits;
    limits.values = 5;
    CHECK_NOTHROW(parse_json("[1,[2,{}]]", limits));
    for (const char* text : {"[1,2,3,4,5]", "[[[[[[]]]]]]", R"({"a":1,"b":2,"c":3,"d":4,"e":5})"})
        CHECK_THROWS_WITH_AS(parse_json(text, limits), "JSON with more than 5 values", Error);
}

TEST_CASE("errors: tokens are unique, and every row has all its texts")
{
    std::set<std::string_view> tokens;
    for (int i = 0; i <= static_cast<int>(Errc::io); ++i) {
        const auto& row = info(static_cast<Errc>(i));
        CHECK(tokens.insert(row.token).second);
        CHECK_FALSE(row.sentence.empty());
        CHECK(row.advice.empty() == (row.code == Errc::refused));  // its text is the reason, and always there
    }
    CHECK_EQ(errc_from_token("on_fire"), Errc::failed);
    CHECK_EQ(errc_from_token(""), Errc::failed);
}

TEST_CASE("json: the error of a text does not repeat the text")
{
    const std::string secret = "{\"password\":\"hunter2\",}";
    CHECK_THROWS_WITH_AS(parse_json(secret), "JSON with an error at byte 23", Error);
}

TEST_CASE("json places: where every key and value begins")
{
    const std::string text = R"({ "a" : [1, -2.5e3 ,true],"b\"}": {"c":"\\", "d":[ ]}, "e":null})";
    const auto parsed = parse_placed_json(text);
    CHECK_EQ(parsed.value, parse_json(text));
    const auto at = [&](std::size_t place, std::string_view what) {
        CHECK_EQ(std::string_view(text).substr(place, what.size()), what);
    };
    REQUIRE_EQ(parsed.place.members.size(), 3u);
    const auto& a = *parsed.place.member("a");
    at(a.key, "\"a\"");
    at(a.value, "[1");
    REQUIRE_EQ(a.items.size(), 3u);
    at(a.items[0].value, "1,");
    at(a.items[1].value, "-2.5e3 ");
    at(a.items[2].value, "true]");
    const auto& b = *parsed.place.member("b\"}");
    at(b.key, "\"b\\\"");
    at(b.member("c")->value, "\"\\\\\"");
    at(b.member("d")->value, "[ ]");
    at(parsed.place.member("e")->value, "null}");
    CHECK_EQ(parsed.place.member("x"), nullptr);
}

TEST_CASE("json places: where a text breaks the rules or a limit")
{
    const auto place_of_mistake = [](const std::string& text, const JsonLimits& limits = {}) {
        try {
            parse_placed_json(text, limits);
        } catch (const JsonMistake& mistake) {
            return static_cast<int>(mistake.at());
        }
        return -1;
    };
    CHECK_EQ(place_of_mistake("[1,,2]"), 3);
    CHECK_EQ(place_of_mistake("[1,2,]"), 5);
    CHECK_EQ(place_of_mistake("[1, tru]"), 4);
    CHECK_EQ(place_of_mistake("[\"abc"), 1);
    CHECK_EQ(place_of_mistake("[1, 1e999]"), 4);
    CHECK_EQ(place_of_mistake("[1, 99999999999999999999]"), 4);
    CHECK_EQ(place_of_mistake("[1, \"\xff\"]"), 4);
    CHECK_EQ(place_of_mistake("{\"a\": 1, \"a\": 2}"), 9);
    CHECK_EQ(place_of_mistake("[1, [2]]", {.depth = 1}), 4);
    CHECK_EQ(place_of_mistake("[1, 2, 3]", {.values = 3}), 7);
    CHECK_EQ(place_of_mistake("[1, \"long\"]", {.string_bytes = 3}), 4);
    CHECK_EQ(place_of_mistake("[1]"), -1);
}

TEST_CASE("text lines: lines and columns from 1, in characters")
{
    const std::string text = "one\n\xC3\xA4 two\r\n\nend";
    const TextLines lines(text);
    const auto at = [&](std::size_t byte) {
        const auto spot = lines.at(byte);
        return std::pair(spot.line, spot.column);
    };
    CHECK(at(0) == std::pair<std::size_t, std::size_t>(1, 1));
    CHECK(at(3) == std::pair<std::size_t, std::size_t>(1, 4));
    CHECK(at(4) == std::pair<std::size_t, std::size_t>(2, 1));
    CHECK(at(7) == std::pair<std::size_t, std::size_t>(2, 3));
    CHECK(at(12) == std::pair<std::size_t, std::size_t>(3, 1));
    CHECK(at(text.size()) == std::pair<std::size_t, std::size_t>(4, 4));
    CHECK(at(1000) == std::pair<std::size_t, std::size_t>(4, 4));
}
