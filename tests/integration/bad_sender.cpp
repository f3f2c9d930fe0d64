// A drone that is none: face is connected to it, and it sends what no sender may send.
#include "pair.hpp"

#include <doctest/doctest.h>

#include <arpa/inet.h>
#include <fcntl.h>
#include <functional>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

using namespace hostile;

namespace {

/// A TCP socket that takes no connection: its queue is full.
class FullSocket {
public:
    FullSocket()
        : listening_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)),
          filling_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0))
    {
        at_.sin_family = AF_INET;
        at_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof at_;
        auto* const any = reinterpret_cast<sockaddr*>(&at_);
        REQUIRE(::bind(listening_, any, size) == 0);
        REQUIRE(::listen(listening_, 0) == 0);
        REQUIRE(::getsockname(listening_, any, &size) == 0);
        REQUIRE(::connect(filling_, any, size) == 0);
    }
    ~FullSocket()
    {
        ::close(filling_);
        ::close(listening_);
    }
    FullSocket(const FullSocket&) = delete;
    FullSocket& operator=(const FullSocket&) = delete;
    [[nodiscard]] std::string address() const { return "tcp://127.0.0.1:" + std::to_string(ntohs(at_.sin_port)); }

private:
    sockaddr_in at_{};
    int listening_, filling_;
};

int received_from_liar(const Prey& prey)
{
    auto doctor = prey.meet("doctor");
    for (const Json inputs = doctor.ask(raw::status).at("result").at("inputs"); const auto& row : inputs)
        if (row.at("from") == "liar.image")
            return row.value("received", 0);
    return -1;
}

Json share(const Json& wrong)
{
    Json share{{"of", "a.b"}, {"epoch", 1}, {"turn", 1}};
    share.update(wrong);
    return share;
}

}  // namespace

TEST_CASE("hostile sender: an event that breaks the rules ends its connection, which is made again; the other "
          "connection loses nothing")
{
    Pair pair;
    Json hops = Json::array();
    for (int i = 0; i < 17; ++i)
        hops.push_back({{"drone", "d"}, {"wait_us", 1}, {"work_us", 1}});
    std::vector<Json> wrong{{{"sender", "../x"}},
                            {{"sender", 1}},
                            {{"kind", ""}},
                            {{"output", nullptr}},
                            {{"type", 1}},
                            {{"source", "a b"}},
                            {{"epoch", -1}},
                            {{"seq", -1}},
                            {{"seq", 1.5}},
                            {{"seq", 9007199254740993}},
                            {{"time_us", "now"}},
                            {{"lossless", 1}},
                            {{"shares", 1}},
                            {{"shares", {1}}},
                            {{"shares", {share({{"of", "no-output"}})}}},
                            {{"shares", {share({{"of", "a.b#"}})}}},
                            {{"shares", {share({{"turn", -1}})}}},
                            {{"shares", {share({{"attempt", -1}})}}},
                            {{"shares", Json(17, share(Json::object()))}},
                            {{"part", -1}},
                            {{"hops", 1}},
                            {{"hops", hops}},
                            {{"hops", {{{"drone", "/"}, {"wait_us", 0}}}}},
                            {{"hops", {1}}},
                            {{"hops", {{{"drone", "d"}, {"wait_us", -1}}}}},
                            {{"size", -1}},
                            {{"header", "text"}},
                            {{"header", nullptr}}};
    for (const auto& each : wrong) {
        CAPTURE(each);
        auto& liar = pair.serve();
        liar.send(pair.event(event_header(each)));
        CHECK(liar.closed_within(within(500)));
    }
    for (const char* field : {"sender", "kind", "output", "type", "source", "epoch", "seq"}) {
        CAPTURE(field);
        Json header = event_header();
        header.erase(field);
        auto& liar = pair.serve();
        liar.send(pair.event(header));
        CHECK(liar.closed_within(within(500)));
    }
    const std::vector<std::pair<const char*, std::function<std::string()>>> packets{
        {"no header", [&] { return raw::packet(raw::event, pair.channel, ""); }},
        {"an array", [&] { return raw::packet(raw::event, pair.channel, "[]"); }},
        {"not UTF-8", [&] { return raw::packet(raw::event, pair.channel, "{\"sender\":\"\xFF\"}"); }},
        {"a header over the limit", [&] { return raw::prefix(raw::event, pair.channel, 65537, 0); }},
        {"a body over the limit", [&] { return raw::prefix(raw::event, pair.channel, 2, 67108865); }},
        {"an unknown packet type", [] { return raw::packet(77, 0, "{}"); }},
        {"a request: it was dialed, and has nothing to ask", [] { return raw::packet(raw::stop, 0, R"({"id":1})"); }},
        {"a request for more", [&] { return raw::packet(raw::request, pair.channel, R"({"epoch":1,"id":2})"); }},
        {"a deregistration", [&] { return raw::packet(raw::deregister, pair.channel, R"({"id":1})"); }},
        {"a second hello", [] { return raw::hello_packet("liar", "camera"); }},
        {"more events than were asked for",
         [&] {
             return pair.event(event_header({{"seq", 2}})) + pair.event(event_header({{"seq", 3}}));
         }},
        {"garbage", [] { return std::string(100, 'g'); }}};
    for (const auto& each : packets) {
        const auto& what = each.first;  // clang 14 captures no bindings
        CAPTURE(what);
        auto& liar = pair.serve();
        liar.send(each.second());
        CHECK(liar.closed_within(within(500)));
    }
    CHECK(pair.prey.well());
    pair.check_camera();
}

TEST_CASE("hostile sender: one that does not even take the connection holds up no end")
{
    const Prey face = Prey::face();
    const FullSocket full;
    auto asker = face.meet();
    REQUIRE(asker.send(raw::packet(raw::connect, 0,
                                   Json{{"id", 1},
                                        {"from", {{"drone", "liar"}, {"output", "image"}, {"address", full.address()}}},
                                        {"input", "image"}}
                                       .dump())));
    CHECK_FALSE(asker.next(Milliseconds(100)));  // it is dialing
    REQUIRE(raw::error_of(asker.ask(raw::stop)) == "");
    CHECK(hive::test::eventually([&] { return face.log().find(": stopped") != std::string::npos; }, within(1000)));
}

TEST_CASE("hostile sender: what is odd but no breach is ignored, and the connection goes on")
{
    Pair pair;
    auto& liar = pair.serve();
    const int wrong_channel = pair.channel + 1;
    const std::vector<std::string> odd{
        raw::packet(raw::event, wrong_channel, event_header().dump(), "x"),
        raw::packet(raw::event, 0, event_header().dump(), "x"),
        raw::packet(raw::event, wrong_channel, "not JSON, and nobody looks", "x"),
        raw::packet(raw::notification, wrong_channel, "{}"),
        raw::packet(raw::exception, wrong_channel, "{}"),
        raw::packet(raw::confirmation, 0, R"({"id":123456,"result":{}})"),
        raw::packet(raw::confirmation, 0, R"({"id":123457,"error":{"code":"no-such-code"}})"),
        raw::packet(raw::ping, 7, ""),
        raw::packet(raw::pong, 0, "")};
    for (const auto& bytes : odd)
        REQUIRE(liar.send(bytes));
    const auto received = [&] { return received_from_liar(pair.prey); };
    CHECK(received() == 0);
    REQUIRE(liar.send(
        pair.event(event_header({{"colour", "red"}, {"size", 999}}))));  // the twin: on its channel it is taken
    CHECK(hive::test::eventually([&] { return received() == 1; }, within(1000)));
    const auto request =
        liar.next_of(raw::request, within(2000));  // dealt with (as an exception), and the next one asked for
    REQUIRE(request);
    CHECK(request->json().at("id") == 2);
    CHECK(request->json().at("epoch") == pair.epoch);
    pair.check_camera();
}

TEST_CASE(
    "hostile sender: a storm of events that may not be lost costs no memory: beyond its credit the sender is cut off")
{
    Pair pair;
    REQUIRE(pair.prey.well());
    const auto memory = hive::test::resident_bytes(pair.prey.pid());
    auto& liar = pair.serve();
    const auto event = pair.event(event_header({{"lossless", true}}), std::string(1000, 's'));
    std::string storm;
    while (storm.size() < 50'000'000)  // put together quickly: who is silent for two seconds is cut off for that
        storm += event;
    liar.send(storm, within(1000));
    CHECK(liar.closed_within(within(1000)));
    CHECK(hive::test::eventually([&] { return pair.prey.log().find("more events than it may") != std::string::npos; },
                                 within(1000)));
    if (!hive::test::sanitized())
        CHECK(hive::test::resident_bytes(pair.prey.pid()) < memory + (12u << 20));
    CHECK(pair.prey.well());
    pair.check_camera();
}

TEST_CASE("honest sender: notifications of events that may not be lost are live, so they need no credit")
{
    Pair pair(Json{{"transfer", "stream"}, {"delivery", "notify"}});
    auto& sender = pair.serve();
    constexpr int count = 1000;
    for (int i = 1; i <= count; ++i)
        REQUIRE(sender.send(raw::packet(raw::notification, pair.channel,
                                        event_header({{"lossless", true}, {"seq", i}, {"size", 9}}).dump())));
    CHECK(hive::test::eventually([&] { return received_from_liar(pair.prey) == count; }, within(2000)));
    CHECK_FALSE(sender.closed_within(Milliseconds(100)));
}

TEST_CASE("hostile sender: a storm over a stream is bounded by the queue, control is answered all the time")
{
    Pair pair(Json{{"transfer", "stream"}});
    REQUIRE(pair.prey.well());
    const auto memory = hive::test::resident_bytes(pair.prey.pid());
    auto& liar = pair.serve();
    auto clock = pair.prey.meet("clock");
    const std::string body(1'000'000, 's');
    std::vector<Milliseconds> answers;
    for (int i = 1; i <= 300; ++i) {
        REQUIRE(liar.send(pair.event(event_header({{"seq", i}, {"type", "image/png"}}), body), within(5000)));
        if (i % 10 == 0)
            answers.push_back(answer_times(clock, 1).front());
    }
    check_answers(answers);
    if (!hive::test::sanitized())
        CHECK(hive::test::resident_bytes(pair.prey.pid()) < memory + (80u << 20));
    CHECK(hive::test::eventually([&] { return pair.prey.well(); }, within(2000)));
}

TEST_CASE(
    "hostile sender: hivectl lives through a drone that answers nonsense, and whom it dialed may ask it for nothing")
{
    const Prey prey = Prey::face();
    raw::Listener listener(prey.swarm().home() / "liar.sock");
    const Claim claim(prey.swarm().home() / "liar.lock");
    const std::vector<std::string> answers{R"({"id":ID,"result":{"parameters":7}})",
                                           R"({"id":ID,"result":{}})",
                                           R"({"id":ID,"result":7})",
                                           R"({"id":ID})",
                                           R"({"id":ID,"error":{"code":"\u001b[31mno","text":"\u001b[2Jbad\u0007"}})",
                                           R"({"id":ID,"error":7})",
                                           "nonsense"};
    std::atomic<bool> over = false;
    std::string to_application;
    std::thread liar([&] {
        std::vector<raw::Peer> peers;
        while (!over) {
            auto peer = listener.accept(Milliseconds(50));
            if (!peer)
                continue;
            peer->send(raw::hello_packet("liar", "camera"));
            if (!peer->next_of(raw::hello, Milliseconds(5000)))
                continue;  // somebody who only looked whether anybody is there, and has closed
            to_application = raw::error_of(peer->ask(raw::describe, Json::object(), 0, {}, Milliseconds(2000)));
            peers.push_back(std::move(*peer));
        }
    });
    const auto get = prey.swarm().hivectl({"get", "liar", "--timeout", "3"}, within(5000));
    over = true;
    liar.join();
    CHECK(get.exit_code != 0);
    CHECK(get.exit_code != 137);
    CHECK(to_application == "no answer");
    for (const auto& answer : answers) {
        std::thread nonsense([&] {
            for (auto peer = listener.accept(within(3000)); peer; peer = listener.accept(Milliseconds(500))) {
                peer->send(raw::hello_packet("liar", "camera"));
                while (const auto packet = peer->next(Milliseconds(700))) {
                    if (packet->type == raw::hello)
                        continue;
                    std::string text = answer;
                    if (const auto at = text.find("ID"); at != std::string::npos)
                        text.replace(at, 2, packet->json().value("id", Json(0)).dump());
                    peer->send(raw::packet(raw::confirmation, 0, text));
                }
            }
        });
        const auto finished = prey.swarm().hivectl({"get", "liar", "scale", "--timeout", "1"}, within(6000));
        nonsense.join();
        CAPTURE(answer);
        CAPTURE(finished.err);
        CHECK(finished.exit_code > 0);
        CHECK(finished.err.find("json.exception") == std::string::npos);
        CHECK(finished.exit_code < 128);
        CHECK(finished.err.find('\x1b') == std::string::npos);
        CHECK(finished.out.find('\x1b') == std::string::npos);
    }
    CHECK(prey.well());
}
