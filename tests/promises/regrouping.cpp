// A connection that changes between plain and shared: nothing is lost, nothing comes twice, and no source waits for a
// group that its members have left.
#include "taking.hpp"

using namespace hive::test;

namespace {

constexpr int given = 120;

struct OneWorker {
    const Swarm swarm;
    const Process source{swarm.drone("ticker", "source", {"pace=demand", "count=" + std::to_string(given)})};
    Process worker{swarm.drone("sleeper", "worker", {"work_ms=5"})};
    hive::Application application{swarm.application()};
    std::unique_ptr<hive::Collector> collector{application.collect({{"worker", "result"}})};

    void connect(const hive::ConnectionOptions& options) const
    {
        swarm.application().connect({"source", "tick"}, {"worker", "image"}, options);
    }
    /// Everything came once.
    void check(Sequences results) const
    {
        std::ranges::copy(take(*collector, given - results.size()), std::back_inserter(results));
        CHECK(listed(sorted(results)) == listed(one_to(given)));
        CHECK(rest(*collector) == 0);
    }
};

}  // namespace

TEST_CASE("regrouping: a worker that is plain and shared in turns gets each event of a source on demand once")
{
    OneWorker one;
    Sequences results;
    for (int i = 0; i < 8; ++i) {
        one.connect(i % 2 == 0 ? hive::ConnectionOptions{.window = 16}
                               : member_of("group-" + std::to_string(i % 3), 4));
        std::ranges::copy(take(*one.collector, 10), std::back_inserter(results));
    }
    one.check(results);
}

TEST_CASE("regrouping: what waits for a slow receiver when it joins a group is not thrown away")
{
    OneWorker one;
    one.collector.reset();
    const auto second = one.swarm.drone("sleeper", "second", {"work_ms=50"});
    const auto collector = one.application.collect({{"second", "result"}});
    one.application.connect({"worker", "result"}, {"second", "image"});
    one.connect({.window = 16});
    auto results = take(*collector, 5);
    one.application.connect({"worker", "result"}, {"second", "image"}, member_of("seconds"));
    one.application.set("second", {{"work_ms", 1}});
    std::ranges::copy(take(*collector, given - results.size()), std::back_inserter(results));
    CHECK(listed(results) == listed(one_to(given)));
    CHECK(rest(*collector) == 0);
}

TEST_CASE("regrouping: a source waits for no group whose killed member is connected plainly")
{
    OneWorker one;
    one.connect(member_of("workers"));
    auto results = take(*one.collector, 20);
    one.worker.kill();
    one.swarm.hivectl_done({"stop", "worker"});  // it forgets its connections
    one.worker = one.swarm.drone("sleeper", "worker");
    one.connect({});
    one.check(results);
}
