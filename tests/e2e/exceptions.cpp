// Exceptions of a drone's code: halt stops taking events until resumed, skip abandons one input and continues.
#include "measure.hpp"
#include "status_sums.hpp"

#include <doctest/doctest.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

std::int64_t count(hive::Application& application, const std::string& drone, std::int64_t hive::InputStatus::*counter)
{
    return at_inputs(application.status(drone), counter);
}

std::int64_t produced(hive::Application& application, const std::string& drone)
{
    return application.status(drone).outputs.at(0).produced;
}

}  // namespace

TEST_CASE(
    "halt: after image 37 nothing is consumed, one exception tells which it was, and resume continues with the newest")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=40"});
    const auto worker = swarm.drone("sleeper", "worker", {"throw_at=37"}, {"--on-exception", "halt"});
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"worker"});
    const auto collector = application.collect({{"worker", "result"}});
    application.connect({"source", ""}, {"worker", ""});

    const auto exception = exceptions->next(patient(10'000ms));
    REQUIRE(exception);
    const auto at = exception->identity.sequence;  // 37, unless the machine was so busy that sync skipped it
    CHECK(at >= 37);
    CHECK(exception->identity.source == "source");
    CHECK(exception->header.at("policy") == "halt");
    CHECK(exception->header.at("input") == "image");
    CHECK(exception->header.at("text") == "event " + std::to_string(at) + " is not to my taste");

    const auto ps = Json::parse(swarm.hivectl_done({"ps", "worker", "--json", "--timeout", "10"}));
    CHECK(ps.at(0).at("state") == "halted");
    CHECK(swarm.hivectl({"wait", "worker", "--for", "halted"}).exit_code == 0);
    const auto refused = swarm.run({"/bin/sh", "-c", "echo x | hivectl put worker - --type text/plain"});
    CHECK(refused.exit_code == 7);
    const auto received = count(application, "worker", &hive::InputStatus::received),
               done = count(application, "worker", &hive::InputStatus::processed);
    const auto made = produced(application, "source");
    REQUIRE(eventually([&] { return produced(application, "source") > made + 30; }));
    CHECK(count(application, "worker", &hive::InputStatus::received) == received);
    CHECK(count(application, "worker", &hive::InputStatus::processed) == done);
    CHECK_FALSE(exceptions->next(100ms));
    std::int64_t last = 0;
    while (const auto result = collector->next(50ms))
        last = result->identity.sequence;
    CHECK(last < 37);  // so `at` was the first that it had from there on

    const auto newest = produced(application, "source");
    swarm.hivectl_done({"resume", "worker"});
    const auto next = collector->next(patient(5000ms));
    REQUIRE(next);
    CHECK(next->identity.sequence >= newest);
    CHECK(application.status("worker").policy == hive::ExceptionPolicy::halt);
    CHECK(count(application, "worker", &hive::InputStatus::abandoned) == 1);
}

TEST_CASE("skip: 36 and 38 appear, 37 is counted as abandoned and reported")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=60"});
    const auto worker = swarm.drone("sleeper", "worker", {"throw_at=37"});
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"worker"});
    const auto collector = application.collect({{"worker", "result"}}, {.ordered = true});
    application.connect({"source", ""}, {"worker", ""});
    for (std::int64_t expected = 1; expected <= 60; ++expected) {
        if (expected == 37)
            continue;
        const auto result = collector->next(patient(3000ms));
        REQUIRE_MESSAGE(result, "no result ", expected);
        REQUIRE(result->identity.sequence == expected);
    }
    CHECK(collector->counts().failed == 1);
    CHECK(collector->counts().missing == 0);
    auto exception = exceptions->next(patient(1000ms));
    REQUIRE(exception);
    CHECK(exception->identity.sequence == 37);
    CHECK(exception->header.at("policy") == "skip");
    hive::Status status;
    CHECK(eventually([&] {
        status = application.status("worker");
        return at_inputs(status, &hive::InputStatus::processed) == 59;
    }));
    CHECK(at_inputs(status, &hive::InputStatus::abandoned) == 1);
    CHECK(at_inputs(status, &hive::InputStatus::processed) == 59);
    CHECK(status.inputs.at(0).abandoned == 1);
    CHECK(status.last_exception.value().sequence == 37);
    const auto shown = swarm.hivectl_done({"exceptions", "worker"});
    CHECK(shown.find("event 37 is not to my taste") != std::string::npos);
}

TEST_CASE("skip: an exception that nobody has subscribed to holds up no source on demand, and results that connect "
          "later come")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=10"});
    const auto worker = swarm.drone("sleeper", "worker", {"throw_at=1"});
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""});
    REQUIRE(eventually([&] { return count(application, "worker", &hive::InputStatus::abandoned) == 1; }));
    const auto collector = application.collect({{"worker", "result"}});
    for (std::int64_t expected = 2; expected <= 10; ++expected) {
        const auto result = collector->next(patient(3000ms));
        REQUIRE_MESSAGE(result, "no result ", expected);
        CHECK(result->identity.sequence == expected);
    }
}

TEST_CASE("policy: it can be changed while the drone runs, and halt by hand lets no event pass until resume")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    swarm.hivectl_done({"connect", "source", "worker"});
    swarm.hivectl_done({"exceptions", "worker", "--on-exception", "halt"});
    CHECK(application.status("worker").policy == hive::ExceptionPolicy::halt);
    swarm.hivectl_done({"set", "worker", "throw_at=1"});
    REQUIRE(eventually([&] { return application.status("worker").state == hive::State::halted; }));
    swarm.hivectl_done({"resume", "worker"});
    const auto done = count(application, "worker", &hive::InputStatus::processed);
    REQUIRE(eventually([&] { return count(application, "worker", &hive::InputStatus::processed) > done; }));
    swarm.hivectl_done({"halt", "worker"});
    const auto at_halt = count(application, "worker", &hive::InputStatus::processed),
               made = produced(application, "source");
    REQUIRE(eventually([&] { return produced(application, "source") > made + 20; }));
    CHECK(count(application, "worker", &hive::InputStatus::processed)
          <= at_halt + 1);  // the one in progress when it was halted
    swarm.hivectl_done({"resume", "worker"});
    CHECK(eventually([&] { return count(application, "worker", &hive::InputStatus::processed) > at_halt + 5; }));
}
