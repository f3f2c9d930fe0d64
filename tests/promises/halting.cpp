// Halting, leaving and throwing: what a drone does not do any more is nobody's loss, and nothing it does ends it.
#include "taking.hpp"

using namespace hive::test;
using hive::Json;

TEST_CASE("halt: a sharing worker that halts and resumes costs a live source no result, and the order stays")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"});
    const auto w1 = swarm.drone("sleeper", "w1", {"work_ms=10"}), w2 = swarm.drone("sleeper", "w2", {"work_ms=10"});
    auto application = swarm.application();
    const auto collector = application.collect({{"w1", "result"}, {"w2", "result"}}, in_order);
    for (const char* worker : {"w1", "w2"})
        application.connect({"source", "tick"}, {worker, "image"}, member_of("workers"));
    auto all = take(*collector, 10);
    for (int i = 0; i < 3; ++i) {
        application.halt("w1");
        std::ranges::copy(take(*collector, 10), std::back_inserter(all));
        application.resume("w1");
        std::ranges::copy(take(*collector, 10), std::back_inserter(all));
    }
    CHECK(collector->counts().missing == 0);
    CHECK(collector->counts().received == 70);
    CHECK(listed(all) == listed(sorted(all)));
}

TEST_CASE("disconnect: what had been sent and was not begun is not worked on any more")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=200"});
    const auto worker = swarm.drone("sleeper", "worker", {"work_ms=80"});
    auto application = swarm.application();
    application.connect({"source", "tick"}, {"worker", "image"}, {.window = 32});
    REQUIRE(eventually([&] { return queued(application, "worker") >= 20; }));
    application.disconnect({"source", ""}, {"worker", ""});
    const auto before = total(application, "worker", "processed");
    REQUIRE(
        eventually([&] { return queued(application, "worker") == 0 && !is_busy(application, "worker"); }, 10'000ms));
    CHECK(total(application, "worker", "processed") <= before + 1);  // the one in hand
}

TEST_CASE("halt: a replay that is started halted gives nothing before it is resumed, whoever receives it already")
{
    const Swarm swarm;
    const auto file = (swarm.home() / "run.hive").string();
    auto application = swarm.application();
    {
        const auto ticker = swarm.drone("ticker", "source", {"fps=500"});
        swarm.hivectl_done({"record", "source", "-o", file, "-n", "50"});
    }
    const auto worker = swarm.drone("sleeper", "worker");
    const std::vector<std::string> start{"replay", file, "--as", "source", "--pace", "demand", "--halted"};
    swarm.hivectl_done(start);
    application.connect({"source", "tick"}, {"worker", "image"});
    application.stop("source");
    for (int i = 0; i < 8; ++i) {
        swarm.hivectl_done(start);
        REQUIRE(eventually([&] { return is_connected(application, "worker"); }));
        CHECK(produced(application, "source") == 0);
        application.stop("source");
    }
    swarm.hivectl_done(start);
    CHECK(status_of(application, "source").at("state") == "halted");
    const auto collector = application.collect({{"worker", "result"}});
    application.resume("source");
    CHECK(take(*collector, 50).size() == 50);
}

TEST_CASE("throw: what is no exception becomes an exception event, wherever a drone's code throws it")
{
    const Swarm swarm;
    const auto drone = swarm.drone("fork", "fork");
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"fork"});
    SUBCASE("in main") { swarm.hivectl({"set", "fork", "bomb=main"}); }
    SUBCASE("in an input's callback")
    {
        swarm.hivectl_done({"set", "fork", "bomb=event"});
        application.put({"fork", "in"}, Json::object(), hive::Body(std::string("x")), "text/plain");
    }
    const auto exception = exceptions->next(patient(2000ms));
    REQUIRE(exception);
    CHECK(exception->sender == "fork");
    CHECK_FALSE(exception->header.value("text", "").empty());
    CHECK(application.get("fork", {"mark"}) == Json{{"mark", 0}});
    CHECK(status_of(application, "fork").at("pid") == drone.pid());
}

TEST_CASE("throw: a set whose on_change throws what is no exception is refused, and the drone goes on with what it had")
{
    const Swarm swarm;
    const auto drone = swarm.drone("fork", "fork");
    const auto refused = swarm.hivectl({"set", "fork", "bomb=change", "mark=7"});
    CAPTURE(refused.err);
    CHECK(refused.exit_code == 5);
    CHECK(swarm.hivectl_done({"get", "fork", "mark"}) == "0\n");
    CHECK(swarm.hivectl_done({"set", "fork", "mark=8"}) == "8\n");
}

TEST_CASE("disconnect: a drone whose results wait for a first receiver leaves at once, and keeps them")
{
    const Swarm swarm;
    const auto source =
        swarm.drone("ticker", "source", {"pace=demand", "count=40"}, {"--expect", "x.image", "--expect", "y.image"});
    const auto x = swarm.drone("sleeper", "x"), y = swarm.drone("sleeper", "y");
    auto application = swarm.application();
    const auto results = application.collect({{"x", "result"}});
    application.connect({"source", "tick"}, {"x", "image"});
    application.connect({"source", "tick"}, {"y", "image"});
    REQUIRE(eventually([&] { return says(application, "y", "held"); }));
    application.disconnect({"source", "tick"}, {"y", "image"});
    CHECK(take(*results, 40) == one_to(40));
    CHECK(take(*application.collect({{"y", "result"}}), 1) == one_to(1));
}

TEST_CASE("halt: what it discards unbegun counts for nothing, and is worked on when it is given out again")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=40"});
    auto middle = swarm.drone("sleeper", "middle");
    const auto last = swarm.drone("sleeper", "last", {"work_ms=300"});
    auto application = swarm.application();
    const auto results = application.collect({{"last", "result"}});
    application.connect({"middle", "result"}, {"last", "image"}, member_of("workers", 4));
    application.connect({"source", "tick"}, {"middle", "image"}, {.window = 8});
    REQUIRE(eventually([&] { return total(application, "last", "received") >= 4; }));
    application.halt("last");
    middle.kill();
    application.set("last", {{"work_ms", 1}});
    application.resume("last");
    middle = swarm.drone("sleeper", "middle");
    CHECK(sorted(take(*results, 40)) == one_to(40));
}
