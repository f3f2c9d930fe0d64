// Parameters of all types, as a drone in C has them and as an application sets them.
#include "world.hpp"

using namespace world;

namespace {

/// The variables of a drone in C, and what its on_change does.
struct Variables {
    int radius = 3;
    double scale = 1.5;
    bool invert = false;
    const char* mode = "fast";
    int changes = 0;
    int threads_seen = 0;
    hive_drone* drone = nullptr;
};

hive_code changed(void* user)
{
    auto& variables = *static_cast<Variables*>(user);
    ++variables.changes;
    if (variables.radius == 13)
        return hive_fail(HIVE_FAILED, "13 brings bad luck");
    if (variables.radius == 7)
        variables.radius = 8;
    if (std::string(variables.mode) == "slow")
        variables.mode = "slower";
    return HIVE_OK;
}

void declare(hive_drone* drone, Variables& variables)
{
    variables.drone = drone;
    REQUIRE(hive_drone_integer(drone, "radius", &variables.radius, R"({"least": 0, "most": 50, "unit": "px"})",
                               "of the blur")
            == HIVE_OK);
    REQUIRE(hive_drone_number(drone, "scale", &variables.scale, R"({"least": 1})", "of the steps") == HIVE_OK);
    REQUIRE(hive_drone_flag(drone, "invert", &variables.invert, nullptr, "light becomes dark") == HIVE_OK);
    REQUIRE(hive_drone_text(drone, "mode", &variables.mode, nullptr, "how") == HIVE_OK);
    REQUIRE(hive_drone_parameter(
                drone, R"({"name": "policy", "type": "text", "default": "a", "choices": ["a", "b"], "help": "which"})")
            == HIVE_OK);
    REQUIRE(hive_drone_on_change(drone, changed, &variables) == HIVE_OK);
    hive_output* output = nullptr;
    REQUIRE(hive_drone_output(drone, "out", "a/b", "nothing", &output) == HIVE_OK);
    hive_release(output);
}

Json set(hive_application* application, const Json& values)
{
    Text applied;
    REQUIRE_MESSAGE(hive_application_set(application, "probe", values.dump().c_str(), applied.place()) == HIVE_OK,
                    error());
    return applied.json();
}

}  // namespace

TEST_CASE("c: parameters of all types are declared with their ranges, begin as they are told, and follow a set")
{
    const Home home;
    Variables variables;
    auto* drone = new_drone("probe", {{"parameters", {{"scale", 2.5}}}});
    declare(drone, variables);
    Text described;
    REQUIRE(hive_drone_describe(drone, described.place(), nullptr) == HIVE_OK);
    const Json parameters = described.json().at("parameters");
    REQUIRE(parameters.size() == 5);
    CHECK(parameters[0].at("max") == 50);
    CHECK(parameters[0].at("unit") == "px");
    CHECK(parameters[4].at("choices") == Json{"a", "b"});

    Running running(drone);
    auto* application = new_application();
    await(application, "probe");
    Text values;
    REQUIRE(hive_application_get(application, "probe", nullptr, values.place()) == HIVE_OK);
    CHECK(values.json() == Json{{"radius", 3}, {"scale", 2.5}, {"invert", false}, {"mode", "fast"}, {"policy", "a"}});
    CHECK(set(application, {{"radius", 5}, {"scale", "3"}, {"invert", true}, {"policy", "b"}})
          == Json{{"radius", 5}, {"scale", 3.0}, {"invert", true}, {"policy", "b"}});
    CHECK(set(application, {{"radius", 7}, {"mode", "slow"}}) == Json{{"radius", 8}, {"mode", "slower"}});
    running.end();
    CHECK(running.result.load() == HIVE_OK);
    CHECK(variables.radius == 8);
    CHECK(variables.scale == 3.0);
    CHECK(variables.invert);
    CHECK(variables.changes == 3);
    hive_release(application);
}

TEST_CASE("c: what is out of range, or what on_change refuses, is refused with the reason and changes nothing")
{
    const Home home;
    Variables variables;
    auto* drone = new_drone("probe");
    declare(drone, variables);
    Running running(drone);
    auto* application = new_application();
    await(application, "probe");
    CHECK(hive_application_set(application, "probe", R"({"radius": 51})", nullptr) == HIVE_REFUSED);
    CHECK(error().find("50") != std::string::npos);
    CHECK(hive_application_set(application, "probe", R"({"policy": "c"})", nullptr) == HIVE_REFUSED);
    CHECK(hive_application_set(application, "probe", R"({"raduis": 1})", nullptr) == HIVE_NOT_FOUND);
    CHECK(hive_application_set(application, "probe", R"({"radius": 13, "invert": true})", nullptr) == HIVE_REFUSED);
    CHECK(error().find("13 brings bad luck") != std::string::npos);
    Text result;
    REQUIRE(hive_application_set_all(application, R"(["probe"])", R"({"radius": 13})", nullptr, nullptr, result.place())
            == HIVE_OK);
    CHECK(result.json().at("changed") == "none");
    CHECK(result.json().at("answers").at(0).at("error").at("code") == "refused");
    REQUIRE(hive_application_set_all(application, R"(["probe"])", R"({"radius": 9})", nullptr, nullptr, result.place())
            == HIVE_OK);
    CHECK(result.json() == Json{{"changed", "all"}, {"answers", {{{"drone", "probe"}, {"result", {{"radius", 9}}}}}}});
    REQUIRE(hive_application_get_all(application, R"(["probe", "nobody"])", R"(["radius", "invert"])", result.place())
            == HIVE_OK);
    CHECK(result.json().at(0).at("result") == Json{{"radius", 9}, {"invert", false}});
    CHECK(result.json().at(1).contains("error"));
    hive_release(application);
}

TEST_CASE("c: a declaration that cannot be is refused, and none comes after the start")
{
    const Home home;
    auto* drone = new_drone("probe");
    int radius = 60;
    for (const char* bad : {R"({"name": "x"})", R"({"name": "x", "type": "integer", "default": 1.5})",
                            R"({"name": "x", "type": "integer", "default": 3000000000})",
                            R"({"name": "x", "type": "colour", "default": 1})",
                            R"({"name": "x", "type": "flag", "default": true, "leats": 1})",
                            R"({"name": "../x", "type": "flag", "default": true})", "[]", "", "{"}) {
        CAPTURE(bad);
        CHECK(hive_drone_parameter(drone, bad) == HIVE_INVALID_ARGUMENT);
    }
    CHECK(hive_drone_integer(drone, "radius", &radius, R"({"most": 50})", "") == HIVE_REFUSED);
    CHECK(hive_drone_integer(drone, "radius", nullptr, nullptr, "") == HIVE_INVALID_ARGUMENT);
    hive_output* twice = nullptr;
    REQUIRE(hive_drone_integer(drone, "width", &radius, nullptr, "") == HIVE_OK);
    CHECK(hive_drone_integer(drone, "width", &radius, nullptr, "") == HIVE_INVALID_ARGUMENT);
    CHECK(error() == "parameter width is declared twice");
    REQUIRE(hive_drone_output(drone, "out", "a/b", "", &twice) == HIVE_OK);
    hive_release(twice);
    CHECK(hive_drone_output(drone, "out", "a/b", "", &twice) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_output(drone, "raw", "raw", "", &twice) == HIVE_INVALID_ARGUMENT);
    CHECK(error() == "output raw: \"raw\" is not a media type");
    CHECK(hive_drone_start(drone) == HIVE_OK);
    CHECK(hive_drone_start(drone) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_run(drone) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_integer(drone, "late", &radius, nullptr, "") == HIVE_INVALID_ARGUMENT);
    hive_output* output = nullptr;
    CHECK(hive_drone_output(drone, "late", "a/b", "", &output) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_drone_end(drone) == HIVE_OK);
    CHECK(hive_drone_end(drone) == HIVE_OK);
    hive_release(drone);
}

TEST_CASE("c: a drone runs in steps, is stopped by an application, and its status outlives its end")
{
    const Home home;
    auto* drone = new_drone("probe");
    CHECK(hive_drone_wake(drone) == HIVE_OK);
    CHECK(hive_drone_stop(drone) == HIVE_INVALID_ARGUMENT);
    Text status;
    CHECK(hive_drone_status(drone, status.place(), nullptr) == HIVE_INVALID_ARGUMENT);
    static int steps;
    steps = 0;
    REQUIRE(hive_drone_main(
                drone,
                [](void*, std::int64_t* wait_us) -> hive_code {
                    ++steps;
                    *wait_us = 3'600'000'000;
                    return HIVE_OK;
                },
                nullptr)
            == HIVE_OK);
    bool goes_on = false;
    CHECK(hive_drone_step(drone, 1, &goes_on) == HIVE_INVALID_ARGUMENT);
    REQUIRE(hive_drone_start(drone) == HIVE_OK);
    for (int i = 0; i < 20; ++i)
        REQUIRE(hive_drone_step(drone, 2, &goes_on) == HIVE_OK);
    CHECK(goes_on);
    CHECK(steps == 1);  // the end of a step is no reason to call main
    std::thread stopper([] {
        auto* application = new_application();
        CHECK(hive_application_stop(application, "probe") == HIVE_OK);
        hive_release(application);
    });
    while (goes_on)
        REQUIRE(hive_drone_step(drone, 50, &goes_on) == HIVE_OK);
    CHECK(hive_drone_end(drone) == HIVE_OK);
    stopper.join();
    REQUIRE(hive_drone_status(drone, status.place(), nullptr) == HIVE_OK);
    CHECK(status.json().at("name") == "probe");
    hive_release(drone);
}
