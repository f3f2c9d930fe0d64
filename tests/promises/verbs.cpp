// Verbs: of several names those that are there are served, and every question has an answer.
#include "taking.hpp"

#include <raw_peer.hpp>

#include <fstream>

using namespace hive::test;
using hive::Json;

TEST_CASE("verbs: connections and exceptions of several names serve those that run, and exit with 8")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto worker = swarm.drone("sleeper", "worker", {"throw_at=1"});
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"worker"});
    application.connect({"source", "tick"}, {"worker", "image"});
    REQUIRE(exceptions->next(patient(5000ms)));
    for (const std::string verb : {"connections", "exceptions"}) {
        CAPTURE(verb);
        const auto some = swarm.hivectl({verb, "gone", "worker", "--json"});
        CHECK(some.exit_code == 8);
        CHECK(has(some.err, "gone is not running"));
        CHECK(has(some.out, "worker"));
        const auto none = swarm.hivectl({verb, "gone", "lost"});
        CHECK(none.exit_code == 3);
        CHECK(has(none.err, "lost is not running"));
    }
}

TEST_CASE("verbs: the exit code says what went wrong, and on stderr there is a sentence")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source"), worker = swarm.drone("sleeper", "worker", {"most_ms=100"});
    const auto fork = swarm.drone("fork", "fork"), track = swarm.drone("track", "track");
    swarm.hivectl_done({"halt", "worker"});
    const auto picture = (swarm.home() / "picture.jpg").string();
    std::ofstream(picture) << "x";
    const std::vector<std::pair<int, std::vector<std::string>>> table{
        {1, {"record", "source", "-o", "/nonexistent/run.hive", "-n", "1"}},
        {1, {"replay", picture}},
        {2, {"set", "worker", "work_ms=1", "work_ms=2"}},
        {2, {"connect", "source", "worker", "--window", "0"}},
        {3, {"get", "worker", "nosuch"}},
        {3, {"halt", "gone"}},
        {3, {"disconnect", "source", "fork"}},
        {5, {"set", "worker", "work_ms=-1"}},
        {5, {"set", "worker", "work_ms=200"}},
        {6, {"connect", "source", "track"}},
        {7, {"put", "worker", picture}},
        {8, {"ps", "worker", "gone"}},
        {8, {"connect", "source", "fork", "gone"}},
        {124, {"results", "worker", "--timeout", "0.2"}}};
    for (const auto& [code, words] : table) {
        CAPTURE(words[0]);
        const auto done = swarm.hivectl(words);
        CHECK_MESSAGE(done.exit_code == code, done.err);
        CHECK(has(done.err, "hivectl " + words[0] + ": "));
    }
}

TEST_CASE("verbs: three connects of one pair at once get three answers, and one connection is there in the end")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=20"}), worker = swarm.drone("sleeper", "worker");
    auto peer = raw::Peer::meet(swarm.home() / "worker.sock");
    const Json from{{"drone", "source"}, {"output", "tick"}};
    std::set<int> asked, answered;
    for (int round = 0; round < 3; ++round) {
        std::string packets;
        for (int i = 1; i <= 3; ++i) {
            const int id = 10 * round + i;
            const Json fields{{"id", id}, {"from", from}, {"input", "image"}, {"options", {{"window", i}}}};
            packets += raw::packet(raw::connect, 0, fields.dump());
            asked.insert(id);
        }
        REQUIRE(peer.send(packets));
        for (int i = 0; i < 3; ++i)
            if (const auto answer = peer.next_of(raw::confirmation, patient(2000ms)))
                answered.insert(answer->json().at("id").get<int>());
    }
    CHECK(listed(answered) == listed(asked));
    auto application = swarm.application();
    CHECK(is_connected(application, "worker"));
    CHECK(eventually([&] { return receivers(application, "source").size() == 1; }));
}

TEST_CASE("standstill: who gets nothing hears for whom the source waits, however far away it is, and so does ps")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    const auto fork = swarm.drone("fork", "fork"), slow = swarm.drone("sleeper", "slow", {"work_ms=60000"}),
               quick = swarm.drone("sleeper", "quick");
    auto application = swarm.application();
    const auto collector = application.collect({{"slow", "result"}});
    application.connect({"source", "tick"}, {"slow", "image"});
    application.connect({"source", "tick"}, {"fork", "in"});
    application.connect({"fork", "left"}, {"quick", "image"});
    REQUIRE(eventually([&] { return is_busy(application, "slow"); }));
    const auto waits = "tick: waits for slow.image to ask";  // as ps says it
    std::string said;
    CHECK(eventually([&] {
        said = swarm.hivectl({"results", "quick", "--timeout", "0.3"}).err;
        return has(said, "source.tick has sent nothing") && has(said, "waits for slow.image");
    }));
    CHECK_MESSAGE(has(swarm.hivectl_done({"ps", "--timeout", "10"}), waits), said);
}

TEST_CASE("standstill: a watcher of a chain on demand is refused in words")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand"});
    const auto worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "source", "worker"});
    std::string said;
    CHECK_MESSAGE(eventually([&] {  // it looks once why nothing comes, for half a second
                      const auto refused = swarm.hivectl({"results", "worker", "--notify", "--timeout", "8"});
                      said = refused.err;
                      return refused.exit_code == 5 && has(said, "--notify is not");
                  }),
                  said);
}
