// Parameters over the wire: read, set, refused, all together or not at all.
#include "subject.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using subject::Json;
using subject::Milliseconds;
using subject::written;

namespace {

Json get_all(raw::Peer& peer) { return peer.ask(raw::get).at("result").at("parameters"); }

/// Values that the parameter cannot take.
std::vector<Json> refused_values(const Json& parameter)
{
    const std::string type = parameter.at("type");
    std::vector<Json> values{nullptr, Json::array(), Json::object()};
    if (parameter.contains("min"))
        values.insert(values.end(), {parameter["min"].get<double>() - 1, written(parameter["min"].get<double>() - 1)});
    if (parameter.contains("max"))
        values.insert(values.end(), {parameter["max"].get<double>() + 1, written(parameter["max"].get<double>() + 1)});
    if (type == "integer")
        values.insert(values.end(), {1.5, "1.0", "0x10", "", " 1", "1e3", 9007199254740993, true});
    if (type == "number")
        values.insert(values.end(), {"nan", "inf", "", "1,5", true});
    if (type == "flag")
        values.insert(values.end(), {"maybe", 1, ""});
    if (type == "text")
        values.insert(values.end(), {1, true, std::string("a\0b", 3)});
    if (parameter.contains("choices"))
        values.push_back("no such choice");
    return values;
}

/// Another value that it can take, if that is known.
Json other_value(const Json& parameter)
{
    if (parameter.at("type") == "flag")
        return !parameter.at("default").get<bool>();
    for (const auto& choice : parameter.value("choices", Json::array()))
        if (choice != parameter.at("default"))
            return choice;
    if (parameter.contains("min") && parameter.contains("max") && parameter.at("type") == "integer") {
        const auto least = parameter["min"].get<std::int64_t>(), most = parameter["max"].get<std::int64_t>(),
                   present = parameter["default"].get<std::int64_t>();
        return present == most ? least : std::min(most, present + 1100);  // a size of 1100 is drawn soon, one of 8192
                                                                          // is not; a port of 1100 is open to all users
    }
    return nullptr;
}

}  // namespace

TEST_CASE("drone: the default of each parameter is what get answers, and can be set, as JSON and as a shell writes it")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    for (const auto& parameter : subject::description().at("parameters")) {
        CAPTURE(parameter);
        const std::string name = parameter.at("name");
        const Json answer = peer.ask(raw::get, {{"names", {name}}});
        REQUIRE(raw::error_of(answer) == "");
        CHECK(answer.at("result").at("parameters") == Json{{name, parameter.at("default")}});
        const std::string text =
            parameter["default"].is_string() ? parameter["default"].get<std::string>() : parameter["default"].dump();
        for (const Json& value : {parameter.at("default"), Json(text)}) {
            const Json set = peer.ask(raw::set, {{"parameters", {{name, value}}}});
            REQUIRE(raw::text_of(set) == "");
            CHECK(set.at("result").at("parameters") == Json{{name, parameter.at("default")}});
        }
    }
    CHECK(get_all(peer).size() == subject::description().at("parameters").size());
}

TEST_CASE("drone: a value out of range is refused with the range in the text, and nothing has changed")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    const Json before = get_all(peer);
    for (const auto& parameter : subject::description().at("parameters"))
        for (const Json& value : refused_values(parameter)) {
            CAPTURE(parameter);
            CAPTURE(value);
            const Json answer = peer.ask(raw::set, {{"parameters", {{parameter.at("name"), value}}}});
            CHECK(raw::error_of(answer) == "refused");
            const std::string text = raw::text_of(answer);
            CAPTURE(text);
            for (const char* end : {"min", "max"})
                if (parameter.contains(end))
                    CHECK(text.find(written(parameter[end])) != std::string::npos);
            for (const auto& choice : parameter.value("choices", Json::array()))
                CHECK(text.find(choice.get<std::string>()) != std::string::npos);
        }
    CHECK(get_all(peer) == before);
}

TEST_CASE("drone: an unknown parameter is not found, and the nearest is named")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    for (const auto& parameter : subject::description().at("parameters")) {
        const std::string name = parameter.at("name"), wrong = name + "x";
        for (const Json& answer : {peer.ask(raw::get, {{"names", {wrong}}}),
                                   peer.ask(raw::set, {{"parameters", {{wrong, parameter.at("default")}}}})}) {
            CHECK(raw::error_of(answer) == "not_found");
            CHECK(raw::text_of(answer).find("mean " + name + "?") != std::string::npos);
        }
    }
}

TEST_CASE("drone: of several parameters in one set either all change or none")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    const Json before = get_all(peer);
    for (const auto& good : subject::description().at("parameters")) {
        const Json value = other_value(good);
        if (value.is_null())
            continue;
        CAPTURE(good);
        for (const auto& bad : subject::description().at("parameters"))
            if (bad != good) {
                const Json both{{good.at("name"), value}, {bad.at("name"), Json::array()}};
                CHECK(raw::error_of(peer.ask(raw::set, {{"parameters", both}})) == "refused");
            }
        CHECK(raw::error_of(peer.ask(raw::set, {{"parameters", {{good.at("name"), value}, {"no-such-parameter", 1}}}}))
              == "not_found");
        const Json check = peer.ask(raw::set, {{"parameters", {{good.at("name"), value}}}, {"check_only", true}});
        CHECK(raw::error_of(check) == "");
        CHECK(check.at("result")
              == Json{{"parameters", {{good.at("name"), value}}},
                      {"previous", {{good.at("name"), before.at(good.at("name"))}}}});
        CHECK(get_all(peer) == before);
        const Json set = peer.ask(raw::set, {{"parameters", {{good.at("name"), value}}}});
        CHECK(raw::text_of(set) == "");
        CHECK(get_all(peer).at(good.at("name")) == value);
        CHECK(raw::error_of(peer.ask(raw::set, {{"parameters", {{good.at("name"), good.at("default")}}}})) == "");
    }
    CHECK(get_all(peer) == before);
}

TEST_CASE("drone: a set whose deadline has passed is not applied; a deadline of more than a day is taken")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    for (const auto& parameter : subject::description().at("parameters")) {
        const Json values{{parameter.at("name"), parameter.at("default")}};
        CHECK(raw::error_of(peer.ask(raw::set, {{"parameters", values}, {"deadline_ms", 0}})) == "timeout");
        CHECK(raw::text_of(peer.ask(raw::set, {{"parameters", values}, {"deadline_ms", std::int64_t{1} << 53}})) == "");
    }
}

namespace {

/// A drone that has prepared a set of one parameter.
struct Prepared {
    explicit Prepared(const subject::Home& home) : asker(home.meet()), other(home.meet()), before(get_all(other))
    {
        for (const auto& parameter : subject::description().at("parameters"))
            if (const Json value = other_value(parameter); wanted.empty() && !value.is_null())
                wanted[parameter.at("name")] = value;
    }
    Json prepare(raw::Peer& peer, int token, int deadline_ms = 5000) const
    {
        return peer.ask(raw::set, {{"parameters", wanted}, {"prepare", token}, {"deadline_ms", deadline_ms}});
    }
    [[nodiscard]] Json after() const
    {
        Json values = before;
        values.update(wanted);
        return values;
    }

    raw::Peer asker, other;
    Json before, wanted = Json::object();
};

}  // namespace

TEST_CASE("drone: a prepared set is tried and told to nobody until it is committed")
{
    const subject::Home home;
    const auto process = home.start();
    Prepared drone(home);
    if (drone.wanted.empty())
        return;  // this drone has no parameter with another value that is known to be taken
    const Json prepared = drone.prepare(drone.asker, 7);
    REQUIRE(raw::text_of(prepared) == "");
    CHECK(prepared.at("result").at("parameters") == drone.wanted);
    CHECK(get_all(drone.other) == drone.before);
    CHECK(raw::error_of(drone.other.ask(raw::describe)) == "");
    CHECK(raw::error_of(drone.other.ask(raw::status)) == "");
    CHECK(drone.other.ask(raw::status).at("result").at("why") == "set_prepared");
    CHECK(raw::error_of(drone.asker.ask(raw::set, {{"commit", 8}})) == "not_found");
    for (const char* decision : {"commit", "abort"})
        CHECK(raw::error_of(drone.other.ask(raw::set, {{decision, 7}})) == "not_found");
    const Json committed = drone.asker.ask(raw::set, {{"commit", 7}});
    CHECK(raw::text_of(committed) == "");
    CHECK(committed.at("result").at("parameters") == drone.wanted);
    CHECK(get_all(drone.other) == drone.after());
    CHECK(raw::error_of(drone.asker.ask(raw::set, {{"commit", 7}})) == "not_found");
}

TEST_CASE("drone: a prepared set that is aborted, whose asker ends, or whose time is over leaves the old values")
{
    const subject::Home home;
    const auto process = home.start();
    Prepared drone(home);
    if (drone.wanted.empty())
        return;
    SUBCASE("aborted")
    {
        REQUIRE(raw::text_of(drone.prepare(drone.asker, 7)) == "");
        CHECK(raw::error_of(drone.asker.ask(raw::set, {{"abort", 7}})) == "");
    }
    SUBCASE("its asker ends")
    {
        REQUIRE(raw::text_of(drone.prepare(drone.asker, 7)) == "");
        drone.asker.close();
    }
    SUBCASE("expired") { REQUIRE(raw::text_of(drone.prepare(drone.asker, 7, 1000)) == ""); }
    // Waits until the first one is decided; within its deadline of 5 s.
    const Json set = drone.other.ask(raw::set, {{"parameters", Json::object()}});
    CHECK(raw::text_of(set) == "");
    CHECK(get_all(drone.other) == drone.before);
    CHECK(raw::error_of(drone.other.ask(raw::set, {{"commit", 7}})) == "not_found");
    CHECK(raw::text_of(drone.prepare(drone.other, 9)) == "");
    CHECK(raw::text_of(drone.other.ask(raw::set, {{"commit", 9}})) == "");
    CHECK(get_all(drone.other) == drone.after());
}

TEST_CASE("drone: while one set is prepared a second prepare is refused at once, and a plain set waits for its end")
{
    const subject::Home home;
    const auto process = home.start();
    Prepared drone(home);
    if (drone.wanted.empty())
        return;
    REQUIRE(raw::text_of(drone.prepare(drone.asker, 7)) == "");
    CHECK(raw::error_of(drone.prepare(drone.other, 8)) == "locked");
    const Json plain = drone.other.ask(raw::set, {{"parameters", drone.wanted}, {"deadline_ms", 100}});
    CHECK(raw::error_of(plain) == "timeout");
    CHECK(raw::error_of(drone.asker.ask(raw::set, {{"abort", 7}})) == "");
    CHECK(raw::text_of(drone.prepare(drone.other, 8)) == "");
    CHECK(raw::error_of(drone.other.ask(raw::set, {{"abort", 8}})) == "");
    CHECK(get_all(drone.other) == drone.before);
}

TEST_CASE("drone: who met a prepared set has the next turn, and loses it when it does not come")
{
    const subject::Home home;
    const auto process = home.start();
    Prepared drone(home);
    if (drone.wanted.empty())
        return;
    auto second = home.meet("second");
    const auto prepare = [&](raw::Peer& peer, int token) { return raw::error_of(drone.prepare(peer, token)); };
    const auto abort = [](raw::Peer& peer, int token) {
        CHECK(raw::error_of(peer.ask(raw::set, {{"abort", token}})) == "");
    };
    CHECK(prepare(drone.asker, 1) == "");
    CHECK(prepare(second, 2) == "locked");
    abort(drone.asker, 1);
    CHECK(prepare(drone.asker, 3) == "locked");
    CHECK(prepare(second, 4) == "");
    CHECK(prepare(drone.asker, 5) == "locked");
    abort(second, 4);
    std::this_thread::sleep_for(Milliseconds(500));  // its turn is over, and nobody comes for the next
    CHECK(prepare(second, 6) == "");
    abort(second, 6);
}

TEST_CASE(
    "drone: a drone that is killed with a prepared set comes back with the old values, after a commit with the new")
{
    const subject::Home home;
    auto process = home.start();
    Prepared drone(home);
    if (drone.wanted.empty())
        return;
    Json expected = drone.before;
    REQUIRE(raw::text_of(drone.prepare(drone.asker, 7)) == "");
    SUBCASE("prepared") {}
    SUBCASE("committed")
    {
        REQUIRE(raw::text_of(drone.asker.ask(raw::set, {{"commit", 7}})) == "");
        expected = drone.after();
    }
    process.kill();
    const auto again = home.start();
    auto peer = home.meet();
    CHECK(get_all(peer) == expected);
}

TEST_CASE("drone: a value that a drone refuses is refused by prepare as well, and locks nobody out")
{
    const subject::Home home;
    const auto process = home.start();
    Prepared drone(home);
    for (const auto& parameter : subject::description().at("parameters")) {
        const Json wrong{{parameter.at("name"), Json::array()}};
        CHECK(raw::error_of(drone.asker.ask(raw::set, {{"parameters", wrong}, {"prepare", 7}})) == "refused");
    }
    CHECK(raw::text_of(drone.prepare(drone.other, 8)) == "");
    CHECK(raw::error_of(drone.other.ask(raw::set, {{"abort", 8}})) == "");
}

TEST_CASE("drone: requests with a wrong field are malformed, and the connection goes on")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    std::vector<std::pair<int, Json>> wrong{{raw::set, Json::object()},
                                            {raw::set, {{"parameters", 1}}},
                                            {raw::set, {{"parameters", Json::array()}}},
                                            {raw::set, {{"parameters", Json::object()}, {"check_only", "yes"}}},
                                            {raw::set, {{"parameters", Json::object()}, {"deadline_ms", -1}}},
                                            {raw::set, {{"parameters", Json::object()}, {"prepare", true}}},
                                            {raw::set, {{"commit", -1}}},
                                            {raw::set, {{"abort", "7"}}},
                                            {raw::get, {{"names", "all"}}},
                                            {raw::get, {{"names", {1}}}},
                                            {raw::connect, Json::object()},
                                            {raw::connect, {{"from", "camera"}, {"input", "image"}}},
                                            {raw::disconnect, Json::object()},
                                            {raw::put, Json::object()},
                                            {raw::put, {{"input", 1}, {"type", "a/b"}}},
                                            {raw::halt, {{"policy", "never"}}},
                                            {raw::forget, Json::object()},
                                            {raw::forget, {{"receiver", ""}}},
                                            {raw::status, {{"skip", -1}}},
                                            {raw::register_, Json::object()},
                                            {raw::register_, {{"epoch", -1}, {"output", "x"}, {"receiver", "r"}}}};
    for (const int type : {raw::register_, raw::deregister, raw::connect, raw::disconnect, raw::set, raw::get,
                           raw::describe, raw::status, raw::halt, raw::resume, raw::stop, raw::put, raw::forget})
        for (const Json& deadline : {Json("soon"), Json(-1), Json(1.5), Json(nullptr)})
            wrong.emplace_back(type, Json{{"deadline_ms", deadline}});
    for (const auto& input : subject::description().at("inputs"))
        wrong.emplace_back(raw::connect,
                           Json{{"from", {{"drone", "../x"}, {"output", "o"}}}, {"input", input.at("name")}});
    for (const auto& [type, fields] : wrong) {
        CAPTURE(type);
        CAPTURE(fields);
        const Json answer = peer.ask(type, fields, type == raw::register_ ? 1 : 0, {}, Milliseconds(3000));
        CHECK(raw::error_of(answer) == "malformed");
        if (peer.ended())
            peer = home.meet();
    }
}
