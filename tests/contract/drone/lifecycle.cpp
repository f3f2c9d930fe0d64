// Names, signals, stop, what is remembered and what is forgotten.
#include "subject.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <signal.h>

namespace fs = std::filesystem;

using subject::Json;
using subject::within;

namespace {

/// What is promised of every drone that is told to end; the best of three tries is held against it.
constexpr auto most_to_end = hive::test::stated(subject::Milliseconds(2000));

/// How long it takes to end, which it must do without an error.
subject::Milliseconds time_to_end(hive::test::Process& process)
{
    const auto begin = hive::test::Clock::now();
    CHECK(process.wait(within(5000)) == 0);
    return std::chrono::duration_cast<subject::Milliseconds>(hive::test::Clock::now() - begin);
}

/// A parameter with another value than its default; null when none is sure to work.
Json changed_parameter()
{
    for (const auto& parameter : subject::description().at("parameters"))
        if (parameter.at("type") == "flag")
            return {{parameter.at("name"), !parameter.at("default").get<bool>()}};
    for (const auto& parameter : subject::description().at("parameters"))
        if (parameter.at("type") == "integer" && parameter.contains("max") && parameter["max"] != parameter["default"])
            return {{parameter.at("name"), parameter["max"].get<std::int64_t>()}};
    return nullptr;
}

}  // namespace

TEST_CASE("drone: a second living claimant of a name is refused, and told the process that holds it")
{
    const subject::Home home;
    const auto first = home.start();
    auto second = home.launch({}, "second");
    const auto exit_code = second.wait(within(20'000));
    REQUIRE(exit_code);
    CHECK(*exit_code != 0);
    CHECK(home.log("second").find(std::to_string(first.pid())) != std::string::npos);
    CHECK(home.answers());
}

TEST_CASE("drone: SIGTERM ends it within two seconds, and its socket is gone")
{
    for (const int signal : {SIGTERM, SIGINT}) {
        auto fastest = subject::Milliseconds::max();
        for (int i = 0; i < 3 && fastest > most_to_end; ++i) {
            const subject::Home home;
            auto process = home.start();
            auto peer = home.meet();
            process.signal(signal);
            fastest = std::min(fastest, time_to_end(process));
            CHECK_FALSE(fs::exists(home.file(".sock")));
            CHECK(peer.closed_within(within(500)));
        }
        CHECK(fastest <= most_to_end);
    }
}

TEST_CASE("drone: what SIGKILL leaves behind blocks no restart, and what the drone was told is still known")
{
    const subject::Home home;
    const Json parameter = changed_parameter();
    {
        auto process = home.start();
        if (!parameter.is_null())
            REQUIRE(raw::error_of(home.meet().ask(raw::set, {{"parameters", parameter}})) == "");
        process.signal(SIGKILL);
        REQUIRE(process.wait(within(2000)) == 128 + SIGKILL);
        CHECK_FALSE(home.answers());
    }
    const auto again = home.start();
    auto peer = home.meet();
    CHECK(peer.first().json().at("pid") == again.pid());
    const Json values = peer.ask(raw::get).at("result").at("parameters");
    if (!parameter.is_null())
        CHECK(values.at(parameter.begin().key()) == *parameter.begin());
}

TEST_CASE("drone: stop is answered, ends it within two seconds, and makes it forget")
{
    const subject::Home home;
    const Json parameter = changed_parameter();
    auto fastest = subject::Milliseconds::max();
    for (int i = 0; i < 3 && fastest > most_to_end; ++i) {
        auto process = home.start();
        auto peer = home.meet();
        if (!parameter.is_null())
            REQUIRE(raw::error_of(peer.ask(raw::set, {{"parameters", parameter}})) == "");
        CHECK(hive::test::eventually([&] { return fs::exists(home.file(".state")); }, within(1000)));
        CHECK(peer.ask(raw::stop).at("result") == Json::object());
        fastest = std::min(fastest, time_to_end(process));
    }
    CHECK(fastest <= most_to_end);
    CHECK_FALSE(fs::exists(home.file(".sock")));
    CHECK_FALSE(fs::exists(home.file(".state")));
    const auto again = home.start();
    const Json values = home.meet().ask(raw::get).at("result").at("parameters");
    for (const auto& each : subject::description().at("parameters"))
        CHECK(values.at(each.at("name")) == each.at("default"));
}

TEST_CASE("drone: halt stops the taking of events and status says so; resume goes on")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    const auto state = [&] { return peer.ask(raw::status).at("result").at("state").get<std::string>(); };
    CHECK(peer.ask(raw::halt).at("result") == Json::object());
    CHECK(hive::test::eventually([&] { return state() == "halted"; }, within(1000)));
    for (const auto& input : subject::description().at("inputs")) {
        std::string type = input.at("type");
        type = type.substr(0, type.find(','));
        CHECK(raw::error_of(peer.ask(raw::put, {{"input", input.at("name")}, {"type", type}}, 0, "x")) == "halted");
    }
    CHECK(peer.ask(raw::resume).at("result") == Json::object());
    CHECK(hive::test::eventually([&] { return state() != "halted"; }, within(1000)));
    for (const char* policy : {"halt", "skip"}) {
        CHECK(raw::error_of(peer.ask(raw::halt, {{"policy", policy}})) == "");
        CHECK(peer.ask(raw::status).at("result").at("policy") == policy);
        CHECK(state() != "halted");
    }
}
