// Requests that come while user code is busy, or several at once: each has its answer, in time.
#include "prey.hpp"

#include <doctest/doctest.h>

#include <optional>

using namespace hostile;

namespace {

Json from_ticker(const std::string& address = {}, int window = 1)
{
    Json from{{"drone", "ticker"}, {"output", "tick"}};
    if (!address.empty())
        from["address"] = address;
    return {{"from", from}, {"input", "image"}, {"options", {{"window", window}}}};
}

std::string connect_packet(int id, Json fields)
{
    fields["id"] = id;
    return raw::packet(raw::connect, 0, fields.dump());
}

/// A sender that confirms only the registrations that a test chooses.
class Ticker {
public:
    explicit Ticker(const Prey& prey) : listener_(prey.swarm().home() / "ticker.sock") {}

    /// The receiver's next connection; the one before ends.
    void meet()
    {
        peer_.reset();
        auto peer = listener_.accept(within(3000));
        REQUIRE(peer);
        peer->send(raw::hello_packet("ticker", "ticker"));
        REQUIRE(peer->next_of(raw::hello, within(3000)));
        peer_.emplace(std::move(*peer));
    }
    void skip(int registrations)
    {
        for (int i = 0; i < registrations; ++i)
            REQUIRE(peer_->next_of(raw::register_, within(3000)));
    }
    /// The next registration.
    void confirm(int window)
    {
        const auto registration = peer_->next_of(raw::register_, within(3000));
        REQUIRE(registration);
        CHECK(registration->json().at("options").value("window", 1) == window);
        const Json result{{"type", "*/*"}, {"kind", "ticker"}, {"epoch", 1}};
        peer_->send(
            raw::packet(raw::confirmation, 0, Json{{"id", registration->json().at("id")}, {"result", result}}.dump()));
    }

private:
    raw::Listener listener_;
    std::optional<raw::Peer> peer_;
};

/// The error of each request, by its id.
Json answers(raw::Peer& peer, int count)
{
    Json all;
    for (int i = 0; i < count; ++i)
        if (const auto answer = peer.next_of(raw::confirmation, within(3000)))
            all[answer->json().at("id").dump()] = raw::error_of(answer->json());
    return all;
}

}  // namespace

TEST_CASE("request: a set is answered at its deadline while user code is busy, and never applied after it")
{
    const Prey prey("sleeper", {"work_ms=4000"});
    auto peer = prey.meet();
    REQUIRE(raw::error_of(peer.ask(raw::put, {{"input", "image"}, {"type", "text/plain"}}, 0, "x")) == "");
    REQUIRE(
        hive::test::eventually([&] { return peer.ask(raw::status).at("result").at("state") == "busy"; }, within(1000)));
    const auto begin = Clock::now();
    const Json answer = peer.ask(raw::set, {{"parameters", {{"work_ms", 7}}}, {"deadline_ms", 200}});
    CHECK(raw::error_of(answer) == "timeout");
    CHECK(Clock::now() - begin > Milliseconds(190));
    CHECK(peer.ask(raw::status).at("result").at("state") == "busy");
    REQUIRE(hive::test::eventually([&] { return peer.ask(raw::status).at("result").at("state") == "idle"; },
                                   within(15'000)));
    CHECK(peer.ask(raw::get).at("result").at("parameters").at("work_ms") == 4000);
    CHECK(raw::error_of(peer.ask(raw::set, {{"parameters", {{"work_ms", 7}}}, {"deadline_ms", 5000}})) == "");
    CHECK(peer.ask(raw::get).at("result").at("parameters").at("work_ms") == 7);
}

TEST_CASE("request: three connects of one pair at once have three answers, and the last one stands")
{
    const Prey prey("sleeper");
    const auto ticker = prey.swarm().drone("ticker", "ticker", {"fps=5"});
    auto peer = prey.meet();
    std::string all;
    for (int i = 1; i <= 3; ++i)
        all += connect_packet(i, from_ticker({}, i));
    REQUIRE(peer.send(all));
    std::string last = "no answer";
    for (int i = 1; i <= 3; ++i) {
        const auto answer = peer.next_of(raw::confirmation, within(3000));
        REQUIRE(answer);
        const Json json = answer->json();
        CHECK((raw::error_of(json) == "" || raw::error_of(json) == "stopped"));
        if (json.at("id") == 3)
            last = raw::error_of(json);
    }
    CHECK(last == "");
    const Json inputs = peer.ask(raw::status).at("result").at("inputs");
    REQUIRE(inputs.size() == 1);
    CHECK(inputs[0].value("options", inputs[0]).at("window") == 3);
}

TEST_CASE("request: a connect that still waits is answered when a later one of the same pair replaces it, or its input "
          "is disconnected")
{
    const Prey prey("sleeper");
    const auto ticker = prey.swarm().drone("ticker", "ticker", {"fps=5"});
    const auto silent = prey.swarm().home() / "silent.sock";
    const raw::Listener listener(silent);  // accepts, and says nothing
    auto peer = prey.meet();
    REQUIRE(peer.send(connect_packet(1001, from_ticker("unix:" + silent.string()))));
    REQUIRE(peer.send(connect_packet(1002, from_ticker())));
    for (const auto& [id, error] : {std::pair{1001, "stopped"}, std::pair{1002, ""}}) {
        const auto answer = peer.next_of(raw::confirmation, within(2000));
        REQUIRE(answer);
        CHECK(answer->json().at("id") == id);
        CHECK(raw::error_of(answer->json()) == error);
    }
    CHECK(peer.ask(raw::status).at("result").at("inputs").size() == 1);
    REQUIRE(peer.send(connect_packet(1003, from_ticker("unix:" + silent.string()))));
    REQUIRE(peer.send(raw::packet(raw::disconnect, 0, R"({"id":1004,"from":{"drone":"ticker"}})")));
    for (const auto& [id, error] : {std::pair{1003, "stopped"}, std::pair{1004, ""}}) {
        const auto answer = peer.next_of(raw::confirmation, within(2000));
        REQUIRE(answer);
        CHECK(answer->json().at("id") == id);
        CHECK(raw::error_of(answer->json()) == error);
    }
    CHECK(peer.ask(raw::status).at("result").at("inputs") == Json::array());
}

TEST_CASE(
    "request: each connect that wanted the options which hold in the end succeeds, whichever the sender confirmed")
{
    const Prey prey("sleeper");
    Ticker ticker(prey);
    auto peer = prey.meet();
    REQUIRE(peer.send(connect_packet(1, from_ticker())));
    ticker.meet();
    ticker.confirm(1);
    CHECK_EQ(answers(peer, 1), Json{{"1", ""}});
    SUBCASE("two equal ones share a registration")
    {
        REQUIRE(peer.send(connect_packet(2, from_ticker({}, 3)) + connect_packet(3, from_ticker({}, 3))));
        ticker.confirm(3);
        CHECK_EQ(answers(peer, 2), Json{{"2", ""}, {"3", ""}});
    }
    SUBCASE("another one comes between them")
    {
        REQUIRE(peer.send(connect_packet(2, from_ticker({}, 3)) + connect_packet(3, from_ticker({}, 4))
                          + connect_packet(4, from_ticker({}, 3))));
        ticker.skip(2);
        ticker.confirm(3);
        CHECK_EQ(answers(peer, 3), Json{{"2", ""}, {"3", "stopped"}, {"4", ""}});
    }
    SUBCASE("the sender is lost before it confirms, and returns")
    {
        REQUIRE(peer.send(connect_packet(2, from_ticker({}, 3)) + connect_packet(3, from_ticker({}, 3))));
        ticker.skip(1);
        ticker.meet();
        ticker.confirm(3);
        CHECK_EQ(answers(peer, 2), Json{{"2", ""}, {"3", ""}});
    }
    const Json inputs = peer.ask(raw::status).at("result").at("inputs");
    REQUIRE(inputs.size() == 1);
    CHECK(inputs[0].value("connected", false));
    CHECK(inputs[0].value("options", inputs[0]).at("window") == 3);
}

TEST_CASE("request: the result of a connect is what the sender answered")
{
    const Prey prey("sleeper");
    const auto ticker = prey.swarm().drone("ticker", "ticker", {"fps=5"});
    const Json result = prey.meet().ask(raw::connect, from_ticker()).at("result");
    CHECK(result.at("kind") == "ticker");
    CHECK(result.at("type") == "application/octet-stream");
    CHECK(result.at("epoch").get<std::int64_t>() > 0);
}

TEST_CASE("request: who is only notified of a camera is told no size while no image is made, and the true one when "
          "somebody takes them")
{
    const Prey prey = Prey::camera();
    auto peer = prey.meet();
    const Json registration{{"epoch", 1},
                            {"output", "image"},
                            {"receiver", "raw"},
                            {"options", {{"transfer", "stream"}, {"delivery", "notify"}}}};
    REQUIRE(raw::error_of(peer.ask(raw::register_, registration, 1)) == "");
    for (int i = 0; i < 3; ++i) {
        const auto notification = peer.next_of(raw::notification, within(2000));
        REQUIRE(notification);
        CHECK_FALSE(notification->json().contains("size"));
    }
    const Witness witness(prey);
    REQUIRE(hive::test::eventually(
        [&] {
            const auto notification = peer.next_of(raw::notification, within(2000));
            return notification && notification->json().value("size", 0) == 320 * 240 * 3;
        },
        within(3000)));
}

TEST_CASE("request: a drone hands over to nobody when no process waits to take over")
{
    const Prey prey("sleeper");
    auto peer = prey.meet();
    const Json answer = peer.ask(raw::stop, {{"successor", true}});
    CHECK(raw::error_of(answer) == "refused");
    CHECK(raw::error_of(peer.ask(raw::stop, {{"successor", 1}})) == "malformed");
    CHECK(peer.ask(raw::status).at("result").at("state") == "idle");
}
