// Each field of an order through JSON and as an option.
#include <hive/drone_order.hpp>
#include <hive/error.hpp>

#include <doctest/doctest.h>

#include <algorithm>

using namespace hive;

namespace {

/// A value that is not the default.
Json other_value(const OrderField& field)
{
    if (field.type == OrderField::Type::flag)
        return true;
    if (field.type == OrderField::Type::amount)
        return field.most;
    return field.words.empty()             ? "x"
           : field.words[0] == field.usual ? std::string(field.words[1])
                                           : std::string(field.words[0]);
}

}  // namespace

TEST_CASE(
    "drone order: each field is what was set, in JSON and on a command line, and left out where it is the default")
{
    CHECK(to_json(DroneOrder{}).empty());
    CHECK(option_words({}).empty());
    for (const auto& field : order_fields()) {
        CAPTURE(field.name);
        const auto value = other_value(field);
        DroneOrder order;
        field.set(order, value);
        CHECK(order != DroneOrder{});
        CHECK_EQ(to_json(order), Json{{field.name, value}});
        CHECK_EQ(drone_order_from_json(to_json(order)), order);
        std::vector<std::string> words{std::string(field.option)};
        if (value.is_string())
            words.push_back(value.get<std::string>());
        CHECK_EQ(option_words(order), field.option.empty() ? std::vector<std::string>{} : words);
        field.copy(order, {});
        CHECK_EQ(order, DroneOrder{});
    }
}

TEST_CASE("drone order: the default in words is the default, and other values than those of a field are refused")
{
    for (const auto& field : order_fields()) {
        CAPTURE(field.name);
        DroneOrder order;
        CHECK_THROWS_AS(field.set(order, Json::array()), Error);
        if (field.type == OrderField::Type::amount)
            for (const Json& wrong : {Json(-1), Json(field.most + 1), Json(1.5), Json("1")})
                CHECK_THROWS_AS(field.set(order, wrong), Error);
        if (field.words.empty())
            continue;
        CHECK_THROWS_AS(field.set(order, "x"), Error);
        field.set(order, field.usual);
        CHECK_FALSE(field.is_given(order));
        CHECK_EQ(field.in_force({}), Json(field.usual));
    }
}
