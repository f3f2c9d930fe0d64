// Shared work: each event gives one result or one exception, never both and never two, however slow its worker is and
// whoever joins, leaves or is connected again meanwhile.
#include "taking.hpp"

#include <functional>

using namespace hive::test;
using hive::Json;

namespace {

/// A source on demand and workers that share it, of which some are killed, halted, connected and disconnected
/// meanwhile.
class ChangingWorkers {
public:
    static constexpr int events = 300;

    ChangingWorkers()
    {
        std::vector<hive::Endpoint> results;
        for (const std::string name : {"w1", "w2", "w3", "w4"}) {
            workers_.emplace(name, swarm_.drone("sleeper", name, {"work_ms=5"}));
            results.push_back({name, "result"});
        }
        collector_ = application_.collect(results);
    }

    hive::Application& application() { return application_; }
    /// What comes until all has come, or nothing more does.
    Sequences run(Milliseconds timeout)
    {
        for (const char* worker : {"w1", "w2", "w3"})
            join(worker, 3);
        const std::vector<std::function<void()>> steps{[&] { join("w4", 2); },
                                                       [&] { kill("w1"); },
                                                       [&] { application_.halt("w2"); },
                                                       [&] {
                                                           application_.disconnect({"source", ""}, {"w4", ""});
                                                       },
                                                       [&] { kill("w3"); },
                                                       [&] { application_.resume("w2"); }};
        Sequences all;
        for (int round = 0; round < 3; ++round)
            for (const auto& step : steps) {
                step();
                std::ranges::copy(take(*collector_, 10, timeout), std::back_inserter(all));
            }
        std::ranges::copy(take(*collector_, events - all.size(), timeout), std::back_inserter(all));
        return all;
    }
    std::size_t surplus() { return rest(*collector_); }

private:
    void join(const std::string& worker, int window)
    {
        application_.connect({"source", "tick"}, {worker, "image"}, member_of("workers", window));
    }
    void kill(const std::string& name)
    {
        workers_.at(name).kill();
        workers_.at(name) = swarm_.drone("sleeper", name);
    }

    Swarm swarm_;
    Process source_{swarm_.drone("ticker", "source", {"pace=demand", "count=" + std::to_string(events)})};
    std::map<std::string, Process> workers_;
    hive::Application application_{swarm_.application()};
    std::unique_ptr<hive::Collector> collector_;
};

/// How many results and exceptions come: there is to be one, and then no more for a while.
std::pair<std::size_t, std::size_t> outcomes(hive::Collector& collector, hive::Collector& exceptions)
{
    std::size_t results = 0, failures = 0;
    eventually([&] {
        results += rest(collector, 10ms);
        failures += rest(exceptions, 10ms);
        return results + failures > 0;
    });
    results += rest(collector);
    failures += rest(exceptions);
    return {results, failures};
}

}  // namespace

TEST_CASE("sharing: an event that outlasts every lease gives its result or an exception, not both")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=1"});
    const std::vector<std::string> names{"w1", "w2", "w3"};
    std::vector<Process> workers;
    for (const auto& name : names)
        workers.push_back(swarm.drone("sleeper", name, {"work_ms=3000"}));
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"source"});
    const auto collector = application.collect({{"w1", "result"}, {"w2", "result"}, {"w3", "result"}}, in_order);
    for (const auto& name : names)
        application.connect({"source", "tick"}, {name, "image"}, member_of("workers", 1, 200ms));
    REQUIRE(eventually([&] { return std::ranges::any_of(names, [&](auto& n) { return is_busy(application, n); }); }));
    REQUIRE(eventually([&] { return std::ranges::none_of(names, [&](auto& n) { return is_busy(application, n); }); },
                       10'000ms));
    const auto [results, failures] = outcomes(*collector, *exceptions);
    CAPTURE(results);
    CAPTURE(failures);
    CHECK(results + failures == 1);
}

TEST_CASE("sharing: members that are connected again while they work use up no attempt")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=8"});
    const auto w1 = swarm.drone("sleeper", "w1", {"work_ms=250"}), w2 = swarm.drone("sleeper", "w2", {"work_ms=250"});
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"source"});
    const auto collector = application.collect({{"w1", "result"}, {"w2", "result"}}, in_order);
    for (int i = 0; i < 20; ++i)
        for (const char* worker : {"w1", "w2"})
            application.connect({"source", "tick"}, {worker, "image"}, member_of("workers", i % 2 + 1));
    CHECK(listed(take(*collector, 8)) == listed(one_to(8)));
    CHECK(rest(*exceptions) == 0);
    CHECK(rest(*collector) == 0);
}

TEST_CASE("sharing: the last member that leaves while it works gives its result or an exception, not both")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=1"});
    const auto worker = swarm.drone("sleeper", "worker", {"work_ms=3000"});
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"source"});
    const auto collector = application.collect({{"worker", "result"}});
    application.connect({"source", "tick"}, {"worker", "image"}, member_of("workers"));
    REQUIRE(eventually([&] { return is_busy(application, "worker"); }));
    application.disconnect({"source", ""}, {"worker", ""});
    REQUIRE(eventually([&] { return !is_busy(application, "worker"); }));
    const auto [results, failures] = outcomes(*collector, *exceptions);
    CAPTURE(results);
    CAPTURE(failures);
    CHECK(results + failures == 1);
}

TEST_CASE("sharing: two outputs of one drone can be shared by the same workers")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=50"});
    const auto fork = swarm.drone("fork", "fork");
    const auto w1 = swarm.drone("sleeper", "w1"), w2 = swarm.drone("sleeper", "w2");
    auto application = swarm.application();
    const auto collector = application.collect({{"w1", "result"}, {"w2", "result"}});
    for (const char* output : {"left", "right"})
        for (const char* worker : {"w1", "w2"})
            application.connect({"fork", output}, {worker, "image"}, member_of("fork"));
    application.connect({"source", "tick"}, {"fork", "in"});
    CHECK(take(*collector, 100, 2000ms).size() == 100);
    CHECK(rest(*collector) == 0);
    CHECK(collector->counts().duplicates == 0);
}

TEST_CASE("sharing: one output of a sharing worker can go to two inputs of one drone")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=30"});
    const auto join = swarm.drone("join", "join"), worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    const auto collector = application.collect({{"join", "counts"}});
    application.connect({"worker", "result"}, {"join", "left"});
    application.connect({"worker", "result"}, {"join", "right"});
    application.connect({"source", "tick"}, {"worker", "image"}, member_of("workers"));
    Json last = Json::object();
    while (last.value("left", 0) + last.value("right", 0) < 60) {
        const auto event = collector->next(patient(2000ms));
        if (!event)
            break;
        last = event->header;
    }
    CHECK(last.dump() == R"({"left":30,"right":30})");
}

TEST_CASE("sharing: each event gives one result while workers are killed, halted, join and leave")
{
    ChangingWorkers workers;
    const auto exceptions = workers.application().exceptions({"source"});
    CHECK(listed(sorted(workers.run(5000ms))) == listed(one_to(ChangingWorkers::events)));
    CHECK(workers.surplus() == 0);
    CHECK(rest(*exceptions) == 0);
}

TEST_CASE("sharing: without leases, events are lost while workers are killed, halted, join and leave")
{
    const SwitchedOff leases("leases");
    ChangingWorkers workers;
    const auto results = workers.run(1000ms);
    CHECK(std::set(results.begin(), results.end()).size() < ChangingWorkers::events);
}

TEST_CASE("sharing: a member that is stopped while its results wait for a first receiver leaves the work to another")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=4"},
                                    {"--expect", "w1.image,group=workers", "--expect", "w2.image,group=workers"});
    const auto w1 = swarm.drone("sleeper", "w1"), w2 = swarm.drone("sleeper", "w2");
    auto application = swarm.application();
    application.connect({"source", "tick"}, {"w1", "image"}, member_of("workers"));
    application.connect({"source", "tick"}, {"w2", "image"}, member_of("workers"));
    REQUIRE(eventually([&] { return says(application, "w1", "held") && says(application, "w2", "held"); }));
    swarm.hivectl_done({"stop", "w1"});
    CHECK(sorted(take(*application.collect({{"w2", "result"}}), 4)) == one_to(4));
}
