// A client in plain sockets and the bytes of SPEC.md talks to the drone.
#include "subject.hpp"

#include <doctest/doctest.h>

#include <sys/socket.h>

using subject::Json;
using subject::Milliseconds;
using subject::within;

namespace {

/// The outputs that some input does not fit: `*/*` fits all.
Json typed_outputs()
{
    Json outputs = Json::array();
    for (const auto& output : subject::description().at("outputs"))
        if (output.at("type") != "*/*")
            outputs.push_back(output);
    return outputs;
}

Json registration(const std::string& output, int epoch, const Json& options = Json::object())
{
    return {{"epoch", epoch}, {"output", output}, {"receiver", "raw.test"}, {"accepts", "*/*"}, {"options", options}};
}

}  // namespace

TEST_CASE("drone: hello names the drone, its kind, its epoch and its process")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    const Json hello = peer.first().json();
    CHECK(hello.at("name") == "subject");
    CHECK(hello.at("kind") == subject::description().at("kind"));
    CHECK(hello.at("pid") == process.pid());
    CHECK(hello.at("epoch").get<std::int64_t>() > 1'600'000'000'000'000);
    CHECK(peer.first().channel == 0);
}

TEST_CASE("drone: describe over the wire is what --describe prints")
{
    const subject::Home home;
    const auto process = home.start();
    const Json answer = home.meet().ask(raw::describe);
    REQUIRE(raw::error_of(answer) == "");
    CHECK(answer.at("result") == subject::description());
}

TEST_CASE("drone: status says who it is and what it does, as the specification lists it")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    const Json answer = peer.ask(raw::status);
    REQUIRE(raw::error_of(answer) == "");
    const Json& status = answer.at("result");
    const Json hello = peer.first().json();
    for (const char* field : {"name", "kind", "pid", "epoch"})
        CHECK(status.at(field) == hello.at(field));
    CHECK((status.at("state") == "idle" || status.at("state") == "busy"));
    CHECK(status.at("policy") == "skip");
    CHECK(status.at("uptime_us").get<std::int64_t>() > 0);
    CHECK(status.at("cpu_us").get<std::int64_t>() > 0);
    CHECK(status.at("machine").at("memory").get<std::int64_t>() > status.at("memory").get<std::int64_t>());
    for (const char* field : {"busy_us", "busy_for_us"})  // numbers that are 0 are left out
        CHECK((!status.contains(field) || status.at(field).get<std::int64_t>() > 0));
    for (const char* field : {"received", "processed", "abandoned", "duplicates"})
        CHECK(status.at("events").at(field) == 0);
    CHECK(status.at("outputs").size() >= subject::description().at("outputs").size());
    CHECK(status.at("inputs") == Json::array());
    CHECK_FALSE(status.contains("last_exception"));
}

TEST_CASE("drone: a ping is answered by a pong, and a peer that only answers pings lives on")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    peer.silent(true);
    REQUIRE(peer.send(raw::packet(raw::ping, 0, "")));
    const auto pong = raw::packet(raw::pong, 0, "");
    std::string heard;  // a ping of the drone's own may come before
    CHECK(hive::test::eventually(
        [&] {
            char more[16];
            const auto count = ::recv(peer.descriptor(), more, sizeof more - heard.size() % sizeof more, MSG_DONTWAIT);
            heard.append(more, count > 0 ? static_cast<std::size_t>(count) : 0);
            return heard.size() % sizeof more == 0 && heard.ends_with(pong);
        },
        within(1000)));
    peer.silent(false);
    CHECK_FALSE(peer.next(Milliseconds(2500)));
    CHECK_FALSE(peer.ended());
}

TEST_CASE("drone: a peer that falls silent is cut off after two seconds, not before")
{
    const subject::Home home;
    const auto process = home.start();
    const auto begin = hive::test::Clock::now();
    auto peer = home.meet();
    CHECK(peer.closed_within(Milliseconds(60'000)));
    CHECK(hive::test::Clock::now() - begin > Milliseconds(1500));
}

TEST_CASE("drone: every output and the exceptions can be registered for and deregistered from")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    Json outputs = subject::description().at("outputs");
    outputs.push_back({{"name", "exceptions"}, {"type", ""}});
    int channel = 0;
    for (const auto& output : outputs) {
        CAPTURE(output);
        const Json options = output.at("name") == "exceptions" ? Json{{"transfer", "stream"}} : Json::object();
        const Json answer = peer.ask(raw::register_, registration(output.at("name"), 7, options), ++channel);
        REQUIRE(raw::text_of(answer) == "");
        if (output.at("name") != "exceptions")
            CHECK(answer.at("result").at("type") == output.at("type"));
        CHECK(answer.at("result").at("kind") == subject::description().at("kind"));
        CHECK(answer.at("result").at("epoch") == peer.first().json().at("epoch"));
        CHECK(peer.send(raw::packet(raw::request, channel, R"({"epoch":7,"id":2,"done":1})")));
    }
    for (; channel > 0; --channel) {
        CHECK(peer.ask(raw::deregister, Json::object(), channel).at("result") == Json::object());
        CHECK(raw::error_of(peer.ask(raw::deregister, Json::object(), channel)) == "not_found");
    }
}

TEST_CASE("drone: what cannot be registered is refused with the code of the specification, and the connection goes on")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    const Json outputs = typed_outputs();
    REQUIRE(raw::error_of(peer.ask(raw::register_, registration("exceptions", 1, {{"transfer", "stream"}}), 1)) == "");
    CHECK(raw::error_of(peer.ask(raw::register_, registration("exceptions", 2, {{"transfer", "stream"}}), 1))
          == "invalid_argument");
    CHECK(raw::error_of(peer.ask(raw::register_, registration("exceptions", 2), 0)) == "invalid_argument");
    CHECK(raw::error_of(peer.ask(raw::register_, registration("exceptionz", 2), 2)) == "not_found");
    Json of_another = registration("exceptions", 2);
    for (const char* receiver : {"face.image", "rawer", "raw-1.test"}) {
        of_another["receiver"] = receiver;
        CHECK(raw::error_of(peer.ask(raw::register_, of_another, 2)) == "not_permitted");
    }
    if (!outputs.empty()) {
        const std::string output = outputs[0].at("name");
        CHECK(raw::error_of(peer.ask(raw::register_, registration(output, 2), 1)) == "invalid_argument");
        Json no_fit = registration(output, 2);
        no_fit["accepts"] = "application/x-nothing";
        const Json answer = peer.ask(raw::register_, no_fit, 2);
        CHECK(raw::error_of(answer) == "type_mismatch");
        CHECK(raw::text_of(answer).find("application/x-nothing") != std::string::npos);
        CHECK(raw::text_of(answer).find(outputs[0].at("type").get<std::string>()) != std::string::npos);
        Json stateful = registration(output, 2, {{"group", "g"}});
        stateful["stateful"] = true;
        CHECK(raw::error_of(peer.ask(raw::register_, stateful, 2)) == "refused");
        for (const Json& options :
             {Json{{"window", 0}}, Json{{"window", 65}}, Json{{"transfer", "fast"}}, Json{{"lease_ms", 1}}})
            CHECK(raw::error_of(peer.ask(raw::register_, registration(output, 2, options), 2)) == "malformed");
    }
    CHECK(raw::error_of(peer.ask(raw::status)) == "");
}

TEST_CASE("drone: unknown fields are ignored, an unknown packet type ends the connection and nothing else")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet(), other = home.meet();
    CHECK(raw::error_of(peer.ask(raw::get, {{"colour", "red"}, {"deep", {{"er", Json::array({1, 2})}}}})) == "");
    CHECK(peer.send(raw::packet(99, 0, R"({"id":77})")));
    CHECK(peer.closed_within(within(1000)));
    CHECK(raw::error_of(other.ask(raw::status)) == "");
}

TEST_CASE(
    "drone: exceptions are registered for like any output: their type must fit, each transfer and delivery is taken")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    Json wrong = registration("exceptions", 1);
    wrong["accepts"] = "a/b";
    const Json refused = peer.ask(raw::register_, wrong, 1);
    CHECK(raw::error_of(refused) == "type_mismatch");
    CHECK(raw::text_of(refused).find("application/x-hive-exception") != std::string::npos);
    int channel = 0;
    for (const char* transfer : {"sync", "stream"})
        for (const char* delivery : {"data", "notify"}) {
            const Json options{{"transfer", transfer}, {"delivery", delivery}};
            const Json answer = peer.ask(raw::register_, registration("exceptions", 1, options), ++channel);
            REQUIRE(raw::text_of(answer) == "");
            CHECK(answer.at("result").at("type") == "application/x-hive-exception");
        }
}

TEST_CASE("drone: a smaller registration epoch is taken, and requests of the earlier registration count no more")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    REQUIRE(raw::error_of(peer.ask(raw::register_, registration("exceptions", 7), 1)) == "");
    REQUIRE(raw::error_of(peer.ask(raw::deregister, Json::object(), 1)) == "");
    REQUIRE(raw::error_of(peer.ask(raw::register_, registration("exceptions", 3), 1)) == "");
    REQUIRE(peer.send(raw::packet(raw::request, 1, R"({"epoch":7,"id":2,"done":1})")));
    CHECK(raw::error_of(peer.ask(raw::status)) == "");
    CHECK(raw::error_of(peer.ask(raw::deregister, Json::object(), 1)) == "");
}

TEST_CASE("drone: a peer that says it is the drone itself is closed, and its twin with another epoch is not")
{
    const subject::Home home;
    const auto process = home.start();
    Json hello = home.meet().first().json();
    auto mirror = raw::Peer::dial(home.file(".sock"));
    REQUIRE(mirror.send(raw::packet(raw::hello, 0, hello.dump())));
    CHECK(mirror.closed_within(within(1000)));
    hello["epoch"] = hello.at("epoch").get<std::int64_t>() + 1;
    auto twin = raw::Peer::dial(home.file(".sock"));
    REQUIRE(twin.send(raw::packet(raw::hello, 0, hello.dump())));
    CHECK(raw::error_of(twin.ask(raw::status)) == "");
}

TEST_CASE("drone: forget finds nothing where nothing waits for that receiver")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    CHECK(raw::error_of(peer.ask(raw::forget, {{"receiver", "nobody.image"}})) == "not_found");
    CHECK(raw::error_of(peer.ask(raw::forget, {{"receiver", "nobody"}, {"output", "exceptions"}})) == "not_found");
}
