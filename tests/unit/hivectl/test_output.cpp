// Tests of escapes and of numbers for people.
#include "words/format.hpp"
#include "words/output.hpp"

#include <doctest/doctest.h>

using namespace hivectl;

TEST_CASE("printable: nothing that steers a terminal passes, everything else does")
{
    CHECK(printable("caf\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x90\x9D") == "caf\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x90\x9D");
    CHECK(printable("a\x1b[31m\n\t\x7f") == "a\\x1b[31m\\n\\t\\x7f");
    CHECK(printable("\xC2\x9B") == "\\x9b");        // the 8-bit control sequence introducer
    CHECK(printable("\xE2\x80\xAE") == "\\u202e");  // right-to-left override
    CHECK(printable("\xFF\xC3") == "\\xff\\xc3");   // not UTF-8
    CHECK(printable("\xE0\x80") == "\\xe0\\x80");   // cut off
}

TEST_CASE("json text: control characters that JSON allows are escapes too, so it stays one line and the same value")
{
    const hive::Json value{{"text", "a\x7f\xC2\x9B\xE2\x80\xA8z"}};
    const std::string text = json_text(value);
    CHECK(text == "{\"text\":\"a\\u007f\\u009b\\u2028z\"}");
    CHECK(hive::parse_json(text) == value);
}

TEST_CASE("durations: two units at most, from microseconds to days")
{
    CHECK(duration_text(850) == "850 us");
    CHECK(duration_text(12'345) == "12 ms");
    CHECK(duration_text(3'450'000) == "3.4 s");
    CHECK(duration_text(59'999'999) == "59.9 s");
    CHECK(duration_text(125'000'000) == "2 min 5 s");
    CHECK(duration_text(120'000'000) == "2 min");
    CHECK(duration_text(11'520'000'000) == "3 h 12 min");
    CHECK(duration_text(187'200'000'000) == "2 d 4 h");
    CHECK(duration_text(-12'345) == "-12 ms");
    CHECK(duration_text(std::numeric_limits<std::int64_t>::min()) == "-106751991 d 4 h");
}

TEST_CASE("counts: one is singular")
{
    CHECK(count_text(0, "event") == "0 events");
    CHECK(count_text(1, "event") == "1 event");
    CHECK(count_text(30, "event") == "30 events");
}

TEST_CASE("durations and sizes are read with the units that people write, and without them in the usual one")
{
    CHECK(seconds_of("5") == 5);
    CHECK(seconds_of("500ms") == 0.5);
    CHECK(seconds_of("2 min") == 120);
    CHECK(seconds_of("20", "ms") == 0.02);
    CHECK(bytes_of("2GB", "MB") == 2e9);
    CHECK(bytes_of("200", "MB") == 200e6);
    for (const auto* wrong : {"", "ms", "5x", "nan", "1e999", "5 min 3"})
        CHECK_FALSE(seconds_of(wrong).has_value());
}
