// Reading fields of objects that came from outside.
#include <hive/error.hpp>
#include <hive/json.hpp>

#include <doctest/doctest.h>

using namespace hive;

namespace {

const Json object =
    Json::parse(R"({"text":"a","name":"face-1","bad_name":"../x","number":5,"negative":-5,"fraction":1.5,"whole":1.0,
    "huge":18446744073709551615,"edge":9007199254740992,"beyond":9007199254740993,
     "flag":true,"object":{"a":1},"array":[1],"null":null})");

/// The text of the error that reading throws; empty if it does not.
template <class Read>
std::string complaint(Read read)
{
    const Fields fields(object, "test");
    try {
        (void)read(fields);
    } catch (const Error& error) {
        CHECK_EQ(error.code(), Errc::malformed);
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("fields: what is there is read")
{
    const Fields fields(object, "test");
    CHECK_EQ(fields.text("text"), "a");
    CHECK_EQ(fields.name("name"), "face-1");
    CHECK_EQ(fields.integer("number", 0, 10), 5);
    CHECK_EQ(fields.integer("negative", -5, 0), -5);
    CHECK_EQ(fields.integer("edge", 0, max_json_integer), max_json_integer);
    CHECK(fields.flag_or("flag", false));
    CHECK_EQ(fields.object("object").at("a"), 1);
    CHECK_EQ(fields.array("array").size(), 1u);
}

TEST_CASE("fields: what is absent has its fallback, or is missing by name")
{
    const Fields fields(object, "test");
    CHECK_EQ(fields.text_or("none", "x"), "x");
    CHECK_EQ(fields.name_or("none", ""), "");
    CHECK_EQ(fields.integer_or("none", 0, 1, 7), 7);
    CHECK(fields.flag_or("none", true));
    CHECK_EQ(complaint([](const Fields& f) { return f.text("none"); }), "test: \"none\" is missing");
    CHECK_EQ(complaint([](const Fields& f) { return f.integer("none", 0, 1); }), "test: \"none\" is missing");
    CHECK_EQ(complaint([](const Fields& f) { return f.array("none"); }), "test: \"none\" is missing");
}

TEST_CASE("fields: a wrong value is told by message, field and what it must be")
{
    CHECK_EQ(complaint([](const Fields& f) { return f.text("number"); }), "test: \"number\" must be a string");
    CHECK_EQ(complaint([](const Fields& f) { return f.name("bad_name"); }), "test: \"bad_name\" must be a name");
    CHECK_EQ(complaint([](const Fields& f) { return f.integer("number", 6, 9); }),
             "test: \"number\" must be a whole number from 6 to 9");
    CHECK_EQ(complaint([](const Fields& f) { return f.flag_or("number", true); }),
             "test: \"number\" must be true or false");
    CHECK_EQ(complaint([](const Fields& f) { return f.object("array"); }), "test: \"array\" must be an object");
    CHECK_EQ(complaint([](const Fields& f) { return f.array("object"); }), "test: \"object\" must be an array");
}

TEST_CASE("fields: null is a wrong value, not an absent one")
{
    CHECK_NE(complaint([](const Fields& f) { return f.text_or("null", ""); }), "");
    CHECK_NE(complaint([](const Fields& f) { return f.name_or("null", ""); }), "");
    CHECK_NE(complaint([](const Fields& f) { return f.integer_or("null", 0, 1, 0); }), "");
    CHECK_NE(complaint([](const Fields& f) { return f.flag_or("null", true); }), "");
}

TEST_CASE("fields: only whole numbers of at most 2^53 are integers")
{
    for (const char* key : {"fraction", "whole", "huge", "beyond", "text", "flag", "array"}) {
        CAPTURE(key);
        CHECK_NE(complaint([&](const Fields& f) { return f.integer(key, INT64_MIN, INT64_MAX); }), "");
    }
}

TEST_CASE("fields: the smallest 64-bit integer is no field either")
{
    const Json smallest{{"n", INT64_MIN}};
    CHECK_THROWS_AS((void)Fields(smallest, "test").integer("n", INT64_MIN, INT64_MAX), Error);
}

TEST_CASE("fields: what is not an object has no fields")
{
    for (const auto& value : {Json(), Json(1), Json("a"), Json::array({1})})
        CHECK_THROWS_WITH_AS(Fields(value, "test"), "test: not a JSON object", Error);
}
