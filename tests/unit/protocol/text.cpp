// Printing: valid UTF-8 always, and nothing that a terminal obeys.
#include <hive/error.hpp>
#include <hive/json.hpp>
#include <hive/printable.hpp>

#include <doctest/doctest.h>

#include <set>

using namespace hive;

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
        CHECK_FALSE(row.advice.empty());
    }
    CHECK_EQ(errc_from_token("on_fire"), Errc::failed);
    CHECK_EQ(errc_from_token(""), Errc::failed);
}

TEST_CASE("json: the error of a text does not repeat the text")
{
    const std::string secret = "{\"password\":\"hunter2\",}";
    CHECK_THROWS_WITH_AS(parse_json(secret), "JSON with an error at byte 23", Error);
}
