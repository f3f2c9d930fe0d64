// A member of the swarm that lies: what it claims counts for its own connection alone, and costs the others nothing.
#include "pair.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <utility>

using namespace hostile;

namespace {

constexpr std::int64_t largest = 9007199254740992;  // 2^53, the largest integer of the protocol
constexpr std::size_t megabyte = 1 << 20;

Json share(int stage, std::int64_t turn = 1, int attempt = 1)
{
    return {{"of", "d" + std::to_string(stage) + ".o#g"}, {"epoch", 1}, {"turn", turn}, {"attempt", attempt}};
}

Json shares(int count)
{
    Json all = Json::array();
    for (int i = 0; i < count; ++i)
        all.push_back(share(i));
    return all;
}

/// Has the memory of the prey stayed within 64 MB of what it was when this began?
class MemoryOf {
public:
    explicit MemoryOf(const Prey& prey) : pid_(prey.pid()), before_(hive::test::resident_bytes(pid_)) {}
    void check() const
    {
        if (!hive::test::sanitized())
            CHECK(hive::test::resident_bytes(pid_) < before_ + 64 * megabyte);
    }

private:
    pid_t pid_;
    std::size_t before_;
};

Json row_of(const Prey& prey, const std::string& rows, const std::string& key, const std::string& value)
{
    auto doctor = prey.meet("doctor");
    for (const Json status = doctor.ask(raw::status).at("result"); const auto& row : status.at(rows))
        if (row.at(key) == value)
            return row;
    return nullptr;
}

Json edge_of(const Prey& prey, const std::string& receiver)
{
    for (const Json output = row_of(prey, "outputs", "name", "tick"); const auto& edge : output.at("edges"))
        if (edge.at("receiver") == receiver)
            return edge;
    return nullptr;
}

Json registration(const std::string& output, const std::string& receiver, const Json& options = Json::object())
{
    return {{"epoch", 1}, {"output", output}, {"receiver", receiver}, {"options", options}};
}

}  // namespace

TEST_CASE("lying member: a claim in an event costs at most the connection that it came by")
{
    Pair pair(Json{{"transfer", "stream"}}, "sleeper");
    const Json long_hops(16, {{"drone", "d"}, {"wait_us", largest}, {"work_us", largest}});
    Json closed = share(0);
    closed["closed"] = largest;
    const std::vector<std::pair<Json, bool>> claims{// is it no breach, so that the event counts?
                                                    {{{"offset_us", largest}, {"time_us", 1}}, true},
                                                    {{{"time_us", largest}, {"mono_us", largest}}, true},
                                                    {{{"hops", long_hops}}, true},
                                                    {{{"shares", {closed}}}, true},
                                                    {{{"shares", shares(16)}, {"lossless", true}}, true},
                                                    {{{"source", "cam"}, {"seq", largest}}, true},
                                                    {{{"sender", "cam"}}, false},
                                                    {{{"kind", "face"}}, false},
                                                    {{{"output", "result"}}, false}};
    for (const auto& each : claims) {
        const Json& claim = each.first;  // clang 14 captures no bindings
        const bool counts = each.second;
        CAPTURE(claim);
        auto& liar = pair.serve();
        const auto before = row_of(pair.prey, "inputs", "from", "liar.image").value("received", 0);
        liar.send(pair.event(event_header(claim)));
        CHECK(liar.closed_within(within(500)) != counts);
        if (counts)
            CHECK(hive::test::eventually(
                [&] { return row_of(pair.prey, "inputs", "from", "liar.image").value("received", 0) == before + 1; },
                within(1000)));
        const auto ps = pair.prey.swarm().hivectl({"ps", "prey", "--json"}, within(3000));
        CHECK_MESSAGE(ps.exit_code == 0, ps.err);
    }
    CHECK(pair.prey.well());
    pair.check_camera();
}

TEST_CASE("lying member: ever other answers, to one work or to ever new ones, cost neither memory nor time")
{
    Pair pair(Json{{"transfer", "stream"}}, "sleeper");
    const MemoryOf memory(pair.prey);
    auto clock = pair.prey.meet("clock");
    std::vector<Milliseconds> answers;
    const std::string name(60, 'n');
    std::function<Json(int)> claim;
    SUBCASE("to one work")
    {
        claim = [](int i) { return Json::array({share(0, 1, i)}); };
    }
    SUBCASE("to ever new ones, with long names")
    {
        claim = [&](int i) {
            Json all = shares(15);
            for (auto& each : all)
                each.update({{"of", name + each.at("of").get<std::string>()}, {"to", name}, {"turn", i}});
            return all;
        };
    }
    auto& liar = pair.serve();
    const int events = hive::test::sanitized() ? 3'000 : 30'000;
    for (int i = 1; i <= events; i += 100) {
        std::string storm;
        for (int k = i; k < i + 100; ++k)
            storm += pair.event(event_header({{"seq", k}, {"shares", claim(k)}}));
        REQUIRE(liar.send(storm, within(5000)));
        clock.send(raw::packet(raw::ping, 0, ""));  // a peer that sends nothing for 2 s is disconnected
        if (i % 500 == 1)
            answers.push_back(answer_times(clock, 1).front());
    }
    check_answers(answers);
    memory.check();
    CHECK(pair.prey.well());
    pair.check_camera();
}

TEST_CASE("lying member: thousands of receivers that register and are gone leave the others their events")
{
    const Prey prey = Prey::camera();
    const Witness witness(prey);
    const MemoryOf memory(prey);
    auto clock = prey.meet("clock");
    std::vector<Milliseconds> answers;
    for (int i = 0; i < 40; ++i) {
        const std::string name = "liar-" + std::to_string(i);
        auto liar = prey.meet(name);
        std::string all;
        for (int k = 1; k <= 64; ++k) {
            Json header = registration("exceptions", name + ".in" + std::to_string(k));
            header["id"] = k;
            all += raw::packet(raw::register_, k, header.dump());
        }
        REQUIRE(liar.send(all));
        for (int k = 1; k <= 64; ++k)
            REQUIRE(liar.next_of(raw::confirmation, within(2000)));
        liar.close();
        answers.push_back(answer_times(clock, 1).front());
    }
    check_answers(answers);
    memory.check();
    CHECK(prey.well());
    CHECK(witness.lost() == 0);
    CHECK_FALSE(witness.cut_off());
}

TEST_CASE("lying member: a receiver has the name of its hello, whatever it says, and takes nobody's place")
{
    const Prey prey("ticker", {"fps=50"});
    auto worker = prey.meet("worker");
    REQUIRE(raw::error_of(worker.ask(raw::register_, registration("tick", "worker.image", {{"transfer", "stream"}}), 1))
            == "");
    auto liar = prey.meet("liar");
    for (const char* receiver : {"worker.image", "worker", "liar2.image"})
        CHECK(raw::error_of(liar.ask(raw::register_, registration("tick", receiver), 1)) == "not_permitted");
    REQUIRE(worker.next_of(raw::event, within(2000)));
    CHECK(edge_of(prey, "worker.image").at("connected") == true);

    // Its place, guessed: the sender gives numbers that cannot be counted up.
    const Json first = liar.ask(raw::register_, registration("tick", "liar.one"), 1);
    const Json second = liar.ask(raw::register_, registration("tick", "liar.two"), 2);
    const std::int64_t one = first.at("result").at("place"), two = second.at("result").at("place");
    CHECK(std::abs(one - two) > 1000);
}

TEST_CASE("lying member: who says of all events that it has worked and of none that it is done is given few")
{
    const Prey prey("ticker", {"pace=demand", "bytes=100000"});
    const MemoryOf memory(prey);
    auto liar = prey.meet("liar");
    REQUIRE(raw::error_of(liar.ask(raw::register_, registration("tick", "liar.in", {{"window", 64}}), 1)) == "");
    int events = 0;
    for (const auto end = Clock::now() + within(2000); Clock::now() < end; ++events) {
        const Json more{{"epoch", 1}, {"id", events + 64}, {"worked", events}};
        REQUIRE(liar.send(raw::packet(raw::request, 1, more.dump())));
        if (!liar.next_of(raw::event, Milliseconds(300)))
            break;
    }
    CHECK(events <= 64 + 256);
    CHECK(edge_of(prey, "liar.in").at("why") == "not_acknowledged");
    memory.check();
    SUBCASE("and who acknowledges is given more")
    {
        const Json done{{"epoch", 1}, {"id", events + 64}, {"worked", events}, {"done", events}};
        REQUIRE(liar.send(raw::packet(raw::request, 1, done.dump())));
        CHECK(liar.next_of(raw::event, within(2000)));
    }
}

TEST_CASE("lying member: a lease of a day, chosen by a member for itself, holds no event for a day")
{
    const Prey prey("ticker", {"pace=demand"});
    auto liar = prey.meet("liar");
    const auto member = [](const std::string& receiver, Json more = Json::object()) {
        more.update({{"group", "g"}});
        return registration("tick", receiver, more);
    };
    REQUIRE(raw::error_of(liar.ask(raw::register_, member("liar.in", {{"lease_ms", 86'400'000}}), 1)) == "");
    REQUIRE(liar.send(raw::packet(raw::request, 1, R"({"epoch":1,"id":1})")));
    REQUIRE(liar.next_of(raw::event, within(2000)));
    auto honest = prey.meet("honest");
    REQUIRE(raw::error_of(honest.ask(raw::register_, member("honest.in"), 1)) == "");
    bool came = false;                                                          // the event of the liar: the first one
    std::jthread alive([&] { liar.next_of(raw::end, Milliseconds(60'000)); });  // it answers pings, and nothing else
    for (int n = 0; n < 20'000 && !came; ++n) {
        const Json more{{"epoch", 1}, {"id", n + 1}, {"worked", n}, {"done", n}};
        REQUIRE(honest.send(raw::packet(raw::request, 1, more.dump())));
        const auto event = honest.next_of(raw::event, Milliseconds(10'000));
        REQUIRE(event);
        came = event->json().at("seq") == 1;
        honest.next(Milliseconds(5));
    }
    CHECK(came);
    prey.swarm().hivectl({"stop", "prey"}, within(5000));
    alive.join();
}

TEST_CASE("lying member: a set that is prepared for a day is over after half a minute, and shown until then")
{
    const Prey prey("sleeper");
    auto liar = prey.meet("liar"), honest = prey.meet("honest");
    const Json day{{"parameters", {{"work_ms", 1}}}, {"prepare", 7}, {"deadline_ms", 86'400'000}};
    REQUIRE(raw::error_of(liar.ask(raw::set, day)) == "");
    const auto begin = Clock::now();
    CHECK(honest.ask(raw::status).at("result").at("why") == "set_prepared");
    std::jthread alive([&] { liar.next_of(raw::end, Milliseconds(33'000)); });
    const Json set{{"parameters", {{"work_ms", 2}}}, {"deadline_ms", 60'000}};
    CHECK(raw::error_of(honest.ask(raw::set, set, 0, {}, Milliseconds(60'000))) == "");
    CHECK(Clock::now() - begin > Milliseconds(29'000));  // the twin: it was held until then
    CHECK(Clock::now() - begin < hive::test::stated(Milliseconds(40'000)));
    alive.join();
}

TEST_CASE("lying member: a status that never ends costs hivectl its own time, and hides nobody else")
{
    const Prey prey("ticker");
    raw::Listener listener(prey.swarm().home() / "liar.sock");
    const Claim claim(prey.swarm().home() / "liar.lock");
    std::jthread liar([&](const std::stop_token& over) {
        while (!over.stop_requested()) {
            auto peer = listener.accept(Milliseconds(50));
            if (!peer)
                continue;
            peer->send(raw::hello_packet("liar", "camera"));
            while (const auto packet = peer->next(Milliseconds(3000))) {
                if (packet->type == raw::hello)
                    continue;
                peer->next(Milliseconds(700));
                const Json page{{"name", "liar"},
                                {"kind", "camera"},
                                {"pid", 1},
                                {"epoch", 1},
                                {"state", "idle"},
                                {"rows_left_out", 1000},
                                {"events", Json::object()},
                                {"inputs", {{{"input", "in"}, {"from", "a.b"}, {"connected", false}}}},
                                {"outputs", Json::array()}};
                peer->send(
                    raw::packet(raw::confirmation, 0, Json{{"id", packet->json().at("id")}, {"result", page}}.dump()));
            }
        }
    });
    const auto begin = Clock::now();
    const auto ps = prey.swarm().hivectl({"ps", "--json", "--timeout", "1"}, within(20'000));
    const auto took = Clock::now() - begin;
    liar.request_stop();
    CHECK(took < within(3000));  // 64 pages at 0.7 s each would be 45 s
    CHECK(ps.out.find("\"prey\"") != std::string::npos);
    CHECK(prey.well());
}
