// Many peers, or one that asks too much: they get their share and nobody else loses his.
#include "prey.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <map>

using namespace hostile;

namespace {

Json registration(int epoch, const std::string& output = "image", const Json& options = Json::object(),
                  const std::string& receiver = "raw")
{
    return {{"epoch", epoch}, {"output", output}, {"receiver", receiver}, {"options", options}};
}

/// Runs `work` again and again in a thread of its own until this ends.
class Meanwhile {
public:
    explicit Meanwhile(std::function<void()> work)
        : thread_([this, work = std::move(work)] {
              while (!stop_)
                  work();
          })
    {
    }
    ~Meanwhile()
    {
        stop_ = true;
        thread_.join();
    }
    Meanwhile(const Meanwhile&) = delete;
    Meanwhile& operator=(const Meanwhile&) = delete;

private:
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

}  // namespace

TEST_CASE("hostile crowd: 64 silent and 64 garbage peers beside a good receiver cost it no event, the drone no memory, "
          "and control no time")
{
    const Prey prey = Prey::camera();
    const Witness witness(prey);
    REQUIRE(hive::test::eventually([&] { return witness.received() > 30; }, within(5000)));
    const auto memory = hive::test::resident_bytes(prey.pid());
    const auto descriptors = hive::test::open_descriptors(prey.pid());
    const int received = witness.received();
    auto clock = prey.meet("clock");
    std::vector<Milliseconds> answers;
    const auto begin = Clock::now();
    {
        std::vector<raw::Peer> silent;
        for (int i = 0; i < 64; ++i)
            silent.push_back(prey.dial());
        std::atomic<int> garbage = 0;
        const Meanwhile attack([&] {
            std::vector<raw::Peer> peers;
            for (int i = 0; i < 64; ++i) {
                peers.push_back(prey.dial());
                peers.back().send(std::string(4096, static_cast<char>(garbage++)), Milliseconds(100));
            }
        });
        answers = answer_times(clock, 60);
        CHECK(garbage >= 64);
    }
    const auto seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    const int during = witness.received() - received;
    MESSAGE(during << " events in " << seconds << " s, " << witness.lost() << " lost");
    check_answers(answers);
    CHECK(witness.lost() * 100 <= during);
    CHECK_FALSE(witness.cut_off());
    if (!hive::test::sanitized()) {
        CHECK(during > 30 * seconds * 0.9 - 3);
        CHECK(hive::test::resident_bytes(prey.pid()) < memory + (5u << 20));
    }
    CHECK(hive::test::eventually([&] { return hive::test::open_descriptors(prey.pid()) <= descriptors + 1; },
                                 within(3000)));
}

TEST_CASE("hostile crowd: a drone accepts no more local peers than it has slots for")
{
    const Prey prey = Prey::camera();
    const auto descriptors = hive::test::open_descriptors(prey.pid());
    std::vector<raw::Peer> peers;
    for (int i = 0; i < 62; ++i)  // two slots are left: one for the garbage, and one for `well`
        peers.push_back(prey.dial());
    auto most = descriptors;
    for (int i = 0; i < 600; ++i) {
        peers.push_back(prey.dial());
        peers.back().send("garbage", Milliseconds(100));
        most = std::max(most, hive::test::open_descriptors(prey.pid()));
    }
    CHECK(most <= descriptors + 64 + 2);
    CHECK(prey.well());
}

TEST_CASE(
    "hostile crowd: of 256 peers with nothing to do here the one that is idle longest makes room, so control gets in")
{
    const Prey prey = Prey::camera();
    const Witness witness(prey);
    std::vector<raw::Peer> peers;
    const auto all_live = [&] {
        for (auto& peer : peers)
            peer.send(raw::packet(raw::ping, 0, ""), Milliseconds(10));
    };
    for (int i = 0; i < 300; ++i) {
        peers.push_back(prey.meet("peer-" + std::to_string(i)));
        if (i % 20 == 0)
            all_live();
        if (i == 254)
            CHECK(raw::error_of(peers[0].ask(raw::status)) == "");  // no longer the one that is idle longest
    }
    all_live();
    CHECK_FALSE(peers[0].closed_within(Milliseconds(0)));
    for (int i = 1; i <= 45; ++i)
        CHECK(peers[static_cast<std::size_t>(i)].closed_within(within(500)));
    CHECK(prey.well());
    CHECK(witness.lost() == 0);
    CHECK_FALSE(witness.cut_off());
    all_live();
    CHECK(prey.swarm().hivectl({"stop", "prey"}).exit_code == 0);
}

TEST_CASE("hostile crowd: peers that have something registered keep their places, and who comes then is turned away")
{
    const Prey prey = Prey::camera();
    std::vector<raw::Peer> peers;
    for (int i = 0; i < 256; ++i) {
        const auto name = "peer-" + std::to_string(i);
        peers.push_back(prey.meet(name));
        const Json options{{"transfer", "stream"}};
        REQUIRE(raw::error_of(peers.back().ask(raw::register_, registration(1, "exceptions", options, name), 1)) == "");
        for (auto& other : peers)
            if (i % 20 == 0)
                other.send(raw::packet(raw::ping, 0, ""), Milliseconds(10));
    }
    auto late = prey.dial();
    late.send(raw::hello_packet("late"), Milliseconds(100));
    CHECK(late.closed_within(within(500)));
    CHECK(raw::error_of(peers[255].ask(raw::status)) == "");
    REQUIRE(raw::error_of(peers[0].ask(raw::deregister, Json::object(), 1)) == "");
    CHECK(prey.well());
}

TEST_CASE("hostile crowd: one that asks and asks without reading the answers is cut off, and the drone's memory stays")
{
    const Prey prey = Prey::camera();
    const Witness witness(prey);
    REQUIRE(hive::test::eventually([&] { return witness.received() > 30; }, within(5000)));
    const auto memory = hive::test::resident_bytes(prey.pid());
    auto peer = prey.meet();
    std::string flood;
    for (int i = 0; i < 1000; ++i)
        flood += raw::packet(raw::describe, 0, R"({"id":)" + std::to_string(i) + "}");
    int rounds = 0;
    while (rounds < 1000 && peer.send(flood, within(3000)))
        ++rounds;
    CHECK(rounds < 100);
    CHECK(peer.closed_within(within(3000)));
    CHECK(hive::test::eventually([&] { return prey.well(); }, within(1000)));
    CHECK(witness.lost() == 0);
    if (!hive::test::sanitized())
        CHECK(hive::test::resident_bytes(prey.pid()) < memory + (5u << 20));
}

TEST_CASE("hostile crowd: the twin of the flood: the same requests are answered, all, when the answers are read")
{
    const Prey prey = Prey::face();
    auto peer = prey.meet();
    for (int round = 0; round < 20; ++round) {
        std::string flood;
        for (int i = 0; i < 100; ++i)
            flood += raw::packet(raw::get, 0, R"({"id":)" + std::to_string(i) + "}");
        REQUIRE(peer.send(flood));
        for (int i = 0; i < 100; ++i) {
            const auto answer = peer.next_of(raw::confirmation, within(2000));
            REQUIRE(answer);
            CHECK(answer->json().at("id") == i);
            CHECK(raw::error_of(answer->json()) == "");
        }
    }
}

TEST_CASE("hostile crowd: of one peer 32 requests may be under way; the next is refused, and others still come through")
{
    const std::string connect = R"(,"from":{"drone":"mute","output":"x"},"input":"image"})";
    const Prey face = Prey::face();
    auto asker = face.meet(), bystander = face.meet();
    const raw::Listener mute(face.swarm().home() / "mute.sock");  // who is told to connect to it waits for a hello
    std::string flood;
    for (int i = 1; i <= 40; ++i)
        flood += raw::packet(raw::connect, 0, R"({"id":)" + std::to_string(i) + connect);
    REQUIRE(asker.send(flood));
    for (int i = 33; i <= 40; ++i) {
        const auto answer = asker.next_of(raw::confirmation, within(1000));
        REQUIRE(answer);
        CHECK(answer->json().at("id") == i);
        CHECK(raw::error_of(answer->json()) == "refused");
    }
    CHECK(raw::error_of(bystander.ask(raw::status)) == "");
    for (int i = 1; i <= 32; ++i) {
        const auto answer = asker.next_of(raw::confirmation, within(6000));
        REQUIRE(answer);
        CHECK(raw::error_of(answer->json()) != "");
    }
    CHECK(raw::error_of(asker.ask(raw::status)) == "");
}

namespace {

/// A registration with a receiver of its own: each has a row.
Json named(int peer, int channel)
{
    return registration(1, "exceptions", {{"transfer", "stream"}},
                        "peer-" + std::to_string(peer) + ".c" + std::to_string(channel));
}

}  // namespace

TEST_CASE("hostile crowd: one peer may register 64 times; a status with too many receivers says how many it leaves out")
{
    const Prey prey = Prey::camera();
    std::vector<raw::Peer> peers;
    for (int i = 0; i < 6; ++i) {
        peers.push_back(prey.meet("peer-" + std::to_string(i)));
        for (int channel = 1; channel <= 64; ++channel) {
            REQUIRE(raw::error_of(peers.back().ask(raw::register_, named(i, channel), channel)) == "");
            if (channel % 16 == 0)  // a peer that sends nothing for 2 s is disconnected
                for (auto& peer : peers)
                    peer.send(raw::packet(raw::ping, 0, ""));
        }
        CHECK(raw::error_of(peers.back().ask(raw::register_, named(i, 65), 65)) == "refused");
    }
    REQUIRE(peers[0].send(raw::packet(raw::status, 0, R"({"id":1000})")));
    const auto answer = peers[0].next_of(raw::confirmation, within(1000));
    REQUIRE(answer);
    CHECK(answer->header.size() <= 65536);
    std::size_t listed = 0;
    const Json status = answer->json();
    REQUIRE(raw::error_of(status) == "");
    for (const auto& output : status.at("result").at("outputs"))
        listed += output.at("edges").size();
    CHECK(listed == 128);
    CHECK(listed + status.at("result").value("rows_left_out", std::size_t{0}) == 6 * 64);
}

TEST_CASE("hostile crowd: the confirmation of a registration comes before its first event")
{
    const Prey prey = Prey::camera();
    const Witness witness(prey);
    REQUIRE(hive::test::eventually([&] { return witness.received() > 3; }, within(5000)));
    auto peer = prey.meet();
    for (int i = 1; i <= 20; ++i) {
        Json json = registration(i, "image", {{"first_frame", true}});
        json["id"] = i;
        REQUIRE(peer.send(raw::packet(raw::register_, i, json.dump())));
        bool confirmed = false, early = false;
        while (const auto packet = peer.next(within(1000))) {
            if (packet->type == raw::confirmation)
                confirmed = true;
            else if (packet->channel == i) {
                early = !confirmed;
                break;
            }
        }
        CHECK(confirmed);
        CHECK_FALSE(early);
    }
}

TEST_CASE("hostile crowd: one peer may not have everything encoded in many ways; those that it may cost others little")
{
    const Prey prey = Prey::camera();
    auto peer = prey.meet();
    std::map<std::string, int> outcomes;
    for (int i = 1; i <= 40; ++i) {
        const auto answer =
            peer.ask(raw::register_, registration(i, "image", {{"encoding", "jpeg:" + std::to_string(i)}}), i);
        ++outcomes[raw::error_of(answer)];
    }
    CHECK(outcomes[""] == 4);
    CHECK(outcomes["refused"] == 36);
    for (int i = 41; i <= 50; ++i)  // the same ones again, and as they are, are not many
        CHECK(raw::error_of(peer.ask(
                  raw::register_, registration(i, "image", i % 2 ? Json{{"encoding", "jpeg:1"}} : Json::object()), i))
              == "");
}

TEST_CASE("hostile crowd: a peer that breaks the rules again and again, or sends what nobody can read, fills no log")
{
    const Prey prey = Prey::face();
    const auto begin = Clock::now();
    for (int i = 0; i < 200; ++i) {
        auto peer = prey.dial();
        peer.send("this is no packet at all");
        REQUIRE(peer.closed_within(within(2000)));
    }
    auto peer = prey.meet();
    for (int i = 0; i < 200; ++i)
        peer.ask(raw::put, {{"input", "image"}, {"type", "image/jpeg"}}, 0, "this is no image at all");
    REQUIRE(prey.well());
    const auto lines = [&](const std::string& part) {
        const std::string log = prey.log();
        std::int64_t count = 0;
        for (std::size_t at = log.find(part); at != std::string::npos; at = log.find(part, at + 1))
            ++count;
        return count;
    };
    for (const char* part : {"closed pid", "exception: malformed"}) {
        CAPTURE(part);
        CHECK(hive::test::eventually([&] { return lines(part) >= 10; }));  // what was put is worked on later
        const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - begin).count();
        CHECK(lines(part) <= 10 * (seconds + 2));
    }
}
