// Second answers: a worker that outlasts its lease answers after another has, and its answer is refused.
#include "taking.hpp"

using namespace hive::test;

namespace {

/// A worker that is slower than its lease and one that is not, so that the first event is worked on twice; its second
/// answer comes in the end.
class LateWorker {
public:
    hive::Application& application() { return application_; }
    [[nodiscard]] bool late_is_done() { return total(application_, "late", "processed") > 0; }
    void connect()
    {
        for (const char* worker : {"late", "quick"})
            application_.connect({"source", "tick"}, {worker, "image"}, member_of("workers", 1, 200ms));
    }
    std::unique_ptr<hive::Collector> collect(const hive::CollectOptions& options = {})
    {
        return application_.collect({{"late", "result"}, {"quick", "result"}}, options);
    }
    [[nodiscard]] const Swarm& swarm() const { return swarm_; }

private:
    Swarm swarm_;
    Process source_{swarm_.drone("ticker", "source", {"pace=demand", "count=20"})};
    Process late_{swarm_.drone("sleeper", "late", {"work_ms=700"})};
    Process quick_{swarm_.drone("sleeper", "quick", {"work_ms=5"})};
    hive::Application application_{swarm_.application()};
};

/// Both workers' results go to two more workers, which share them.
class TwoStages {
public:
    TwoStages()
    {
        for (const std::string stage : {"late", "quick"})
            for (const char* worker : {"u1", "u2"})
                first_.application().connect({stage, "result"}, {worker, "image"}, member_of(stage));
    }
    std::unique_ptr<hive::Collector> collect(const hive::CollectOptions& options = {})
    {
        return first_.application().collect({{"u1", "result"}, {"u2", "result"}}, options);
    }
    LateWorker& first() { return first_; }

private:
    LateWorker first_;
    Process u1_{first_.swarm().drone("sleeper", "u1")}, u2_{first_.swarm().drone("sleeper", "u2")};
};

/// Does any sequence come a second time?
bool seen_twice(hive::Collector& collector)
{
    std::set<std::int64_t> seen;
    while (const auto event = collector.next(patient(3000ms)))
        if (!seen.insert(event->identity.sequence).second)
            return true;
    return false;
}

}  // namespace

TEST_CASE("sharing: a late worker's second answer is refused")
{
    LateWorker swarm;
    const auto collector = swarm.collect();
    swarm.connect();
    CHECK(listed(sorted(take(*collector, 20))) == listed(one_to(20)));
    REQUIRE(eventually([&] { return swarm.late_is_done(); }));
    CHECK(rest(*collector) == 0);
}

TEST_CASE("sharing: when second answers are not refused, a late worker's result comes twice")
{
    const SwitchedOff filter("answer-filter");
    LateWorker swarm;
    const auto collector = swarm.collect();
    swarm.connect();
    CHECK(seen_twice(*collector));
}

TEST_CASE("sharing: of two shared stages with a late worker in the first, each result comes once and in order")
{
    TwoStages swarm;
    const auto collector = swarm.collect(in_order);
    swarm.first().connect();
    CHECK(listed(take(*collector, 20)) == listed(one_to(20)));
    REQUIRE(eventually([&] { return swarm.first().late_is_done(); }));
    CHECK(rest(*collector) == 0);
    CHECK(collector->counts().missing == 0);
}

TEST_CASE("sharing: when second answers are not refused, two shared stages give a late worker's result twice")
{
    const SwitchedOff filter("answer-filter");
    TwoStages swarm;
    const auto collector = swarm.collect();
    swarm.first().connect();
    CHECK(seen_twice(*collector));
}
