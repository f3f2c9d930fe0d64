// What a refused value is told, and that ranges are readable. The values themselves: tests/wire.
#include <hive/error.hpp>
#include <hive/interface.hpp>

#include <doctest/doctest.h>

using namespace hive;

namespace {

const ParameterInfo scale{"scale", ParameterType::number, 1.1, 1.01, 2.0, {}, "", ""};
const ParameterInfo quality{"quality", ParameterType::integer, 90, 1, 100, {}, "%", ""};
const ParameterInfo format{"format", ParameterType::text, "jpeg", std::nullopt, std::nullopt, {"jpeg", "png"}, "", ""};

std::string refusal(const ParameterInfo& parameter, const Json& value)
{
    try {
        (void)checked_value(parameter, value);
    } catch (const Error& error) {
        CHECK_EQ(error.code(), Errc::refused);
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("parameter: a range reads as people write it")
{
    CHECK_EQ(range_text(scale), "1.01 to 2");
    CHECK_EQ(range_text(format), "jpeg | png");
    CHECK_EQ(range_text({"a", ParameterType::integer, 1, 1, std::nullopt, {}, "", ""}), "at least 1");
    CHECK_EQ(range_text({"a", ParameterType::integer, 1, std::nullopt, 9.5, {}, "", ""}), "at most 9.5");
    CHECK_EQ(range_text({"a", ParameterType::integer, 0, 0, 600'000, {}, "", ""}), "0 to 600000");
    CHECK_EQ(range_text({"a", ParameterType::integer, 0, 0, max_json_integer, {}, "", ""}), "0 to 9007199254740992");
    CHECK_EQ(range_text({"a", ParameterType::number, 0, 1e-7, 1e20, {}, "", ""}), "1e-07 to 1e+20");
    CHECK_EQ(range_text({"a", ParameterType::text, "", std::nullopt, std::nullopt, {}, "", ""}), "");
}

TEST_CASE("parameter: a refusal names parameter, value and what is allowed")
{
    CHECK_EQ(refusal(scale, 9), "scale=9: must be a number, 1.01 to 2");
    CHECK_EQ(refusal(quality, "high"), "quality=\"high\": must be a whole number, 1 to 100 %");
    CHECK_EQ(refusal(format, "gif"), "format=\"gif\": must be one of these, jpeg | png");
    CHECK_EQ(refusal({"on", ParameterType::flag, true, std::nullopt, std::nullopt, {}, "", ""}, "maybe"),
             "on=\"maybe\": must be on or off");
}

TEST_CASE("parameter: a refusal repeats no more than the beginning of a giant value")
{
    CHECK_LT(refusal(scale, std::string(10'000, 'x')).size(), 400u);
    CHECK_LT(refusal(scale, Json(std::vector<int>(10'000, 1))).size(), 400u);
}

TEST_CASE("parameter: a whole number given for a number becomes one, so that the answer has one type")
{
    CHECK(checked_value(scale, 2).is_number_float());
    CHECK(checked_value(quality, "7").is_number_integer());
}
