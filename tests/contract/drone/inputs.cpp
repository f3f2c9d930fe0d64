// Bad events at the inputs: refused or reported, and the drone lives on.
#include "subject.hpp"

#include <doctest/doctest.h>

using subject::Json;
using subject::within;

namespace {

raw::Peer with_exceptions(const subject::Home& home)
{
    auto peer = home.meet();
    const Json registration{
        {"epoch", 1}, {"output", "exceptions"}, {"receiver", "raw"}, {"options", {{"transfer", "stream"}}}};
    REQUIRE(raw::error_of(peer.ask(raw::register_, registration, 9)) == "");
    return peer;
}

}  // namespace

TEST_CASE(
    "drone: an event of a type that the input does not take is refused with both types; an unknown input is not found")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    CHECK(raw::error_of(peer.ask(raw::put, {{"input", "no-such-input"}, {"type", "image/jpeg"}}, 0, "x"))
          == "not_found");
    for (const auto& input : subject::description().at("inputs")) {
        if (input.at("type").get<std::string>().find("*/*") != std::string::npos)
            continue;
        const Json answer =
            peer.ask(raw::put, {{"input", input.at("name")}, {"type", "application/x-nothing"}}, 0, "x");
        CHECK(raw::error_of(answer) == "type_mismatch");
        CHECK(raw::text_of(answer).find("application/x-nothing") != std::string::npos);
        CHECK(raw::text_of(answer).find(input.at("type").get<std::string>()) != std::string::npos);
    }
    CHECK(peer.ask(raw::status).at("result").at("events").at("received") == 0);
}

TEST_CASE("drone: garbage put to an image input gives one exception each, with the input's identity, and no result; "
          "the drone lives on")
{
    const std::vector<std::pair<std::string, std::string>> garbage{{"image/jpeg", ""},
                                                                   {"image/jpeg", "x"},
                                                                   {"image/jpeg", std::string(100'000, '\xFF')},
                                                                   {"image/jpeg", "\xFF\xD8\xFF\xD9"},
                                                                   {"image/png", "\x89PNG\r\n\x1A\n"},
                                                                   {"image/raw", std::string(1000, 'r')}};
    for (const auto& input : subject::image_inputs()) {
        const subject::Home home;
        const auto process = home.start();
        auto peer = with_exceptions(home);
        for (const auto& [type, body] : garbage) {
            CAPTURE(type);
            CAPTURE(body.size());
            std::optional<raw::Packet> exception;
            REQUIRE(peer.send(raw::packet(
                raw::put, 0, Json{{"id", 4000 + body.size()}, {"input", input}, {"type", type}}.dump(), body)));
            REQUIRE((exception = peer.next_of(raw::exception, within(2000))));
            const Json header = exception->json();
            CHECK(exception->channel == 9);
            CHECK(exception->body.empty());
            CHECK(header.at("sender") == "subject");
            CHECK(header.at("output") == "exceptions");
            CHECK(header.at("source") == "raw");
            CHECK(header.at("epoch") != peer.first().json().at("epoch"));  // that of the asker, not of the drone
            CHECK(header.at("seq") == 4000 + body.size());
            CHECK(header.at("header").at("code") == "malformed");
            CHECK(header.at("header").at("policy") == "skip");
            CHECK(header.at("header").at("input") == input);
        }
        Json status;
        CHECK(hive::test::eventually(  // the exception is sent before it is counted
            [&] {
                status = peer.ask(raw::status).at("result");
                return status.at("events").at("abandoned") == garbage.size();
            },
            within(1000)));
        CHECK(status.at("last_exception").at("code") == "malformed");
        for (const auto& output : status.at("outputs"))
            if (output.at("name") != "exceptions")
                CHECK(output.at("produced") == 0);
    }
}

TEST_CASE("drone: with the policy halt the first exception halts it")
{
    for (const auto& input : subject::image_inputs()) {
        const subject::Home home;
        const auto process = home.start({"--on-exception", "halt"});
        auto peer = with_exceptions(home);
        REQUIRE(peer.send(
            raw::packet(raw::put, 0, Json{{"id", 4000}, {"input", input}, {"type", "image/jpeg"}}.dump(), "garbage")));
        const auto exception = peer.next_of(raw::exception, within(2000));
        REQUIRE(exception);
        CHECK(exception->json().at("header").at("policy") == "halt");
        CHECK(hive::test::eventually([&] { return peer.ask(raw::status).at("result").at("state") == "halted"; },
                                     within(1000)));
    }
}

TEST_CASE("drone: no input takes an output of the drone itself, and one that has halted takes no event")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    for (const auto& input : subject::description().at("inputs")) {
        const Json itself{{"from", {{"drone", "subject"}, {"output", "exceptions"}}}, {"input", input.at("name")}};
        const Json answer = peer.ask(raw::connect, itself);
        CHECK(raw::error_of(answer) == "invalid_argument");
        CHECK(raw::text_of(answer).find("own output") != std::string::npos);
    }
    CHECK(peer.ask(raw::status).at("result").at("inputs") == Json::array());
    REQUIRE(raw::error_of(peer.ask(raw::halt)) == "");
    for (const auto& input : subject::description().at("inputs"))
        CHECK(raw::error_of(peer.ask(raw::put, {{"input", input.at("name")}, {"type", "image/jpeg"}}, 0, "x"))
              == "halted");
}

TEST_CASE("drone: what --connect names is waited for, is told in the status, and is remembered after a crash")
{
    for (const auto& input : subject::description().at("inputs")) {
        const auto name = input.at("name").get<std::string>();
        const subject::Home home;
        auto process = home.start({"--connect", name + "=nobody.image,window=3"});
        const auto rows = [&] { return home.meet().ask(raw::status).at("result").at("inputs"); };
        REQUIRE(rows().size() == 1);
        CHECK(rows()[0].at("input") == name);
        CHECK(rows()[0].at("from") == "nobody.image");
        CHECK_FALSE(rows()[0].contains("connected"));
        CHECK(rows()[0].at("why") == "dialing");
        process.kill();
        process = home.start();
        REQUIRE(rows().size() == 1);
        CHECK(rows()[0].at("options").at("window") == 3);
    }
}
