// A drone that is started again, or replaced, goes on for those for whom it worked: each of them gets everything once.
#include "status_sums.hpp"
#include "taking.hpp"

#include <functional>

using namespace hive::test;

namespace {

constexpr int emitted = 150;

/// A source on demand, and a drone in the middle that is started again and again while its receivers work.
struct Middle {
    const Swarm swarm;
    const Process source{swarm.drone("ticker", "source", {"pace=demand", "count=" + std::to_string(emitted)})};
    Process middle;
    const Process x{swarm.drone("sleeper", "x", {"work_ms=4"})}, y{swarm.drone("sleeper", "y", {"work_ms=4"})};
    hive::Application application{swarm.application()};
    std::unique_ptr<hive::Collector> of_x{application.collect({{"x", "result"}})},
        of_y{application.collect({{"y", "result"}})};

    explicit Middle(const std::string& kind) : middle(swarm.drone(kind, "middle")) {}

    void kill_and_start(const std::string& kind)
    {
        middle.kill();
        middle = swarm.drone(kind, "middle");
    }
    /// @param again  what starts the one in the middle again
    void run(const std::function<void()>& again, const std::string& input = "image")
    {
        application.connect({"source", "tick"}, {"middle", input}, {.window = 2});
        Sequences from_x, from_y;
        for (int i = 0; i < emitted / 10; ++i) {
            std::ranges::copy(take(*of_x, 10), std::back_inserter(from_x));
            std::ranges::copy(take(*of_y, 10), std::back_inserter(from_y));
            if (i < 6)
                again();
        }
        CHECK(listed(sorted(from_x)) == listed(one_to(emitted)));
        CHECK(listed(sorted(from_y)) == listed(one_to(emitted)));
        CHECK(rest(*of_x) + rest(*of_y) == 0);
    }
};

}  // namespace

TEST_CASE("returning: two plain receivers of a drone that is killed again and again miss nothing")
{
    Middle line("sleeper");
    line.application.connect({"middle", "result"}, {"x", "image"}, {.window = 2});
    line.application.connect({"middle", "result"}, {"y", "image"});
    line.run([&] { line.kill_and_start("sleeper"); });
}

TEST_CASE("returning: a receiver at each of two outputs of a drone that is replaced again and again misses nothing")
{
    Middle line("fork");
    line.application.connect({"middle", "left"}, {"x", "image"});
    line.application.connect({"middle", "right"}, {"y", "image"}, {.window = 2});
    line.run([&] { line.swarm.hivectl_done({"replace", "middle"}, 60s); }, "in");
}

TEST_CASE("returning: a group and a plain receiver of a drone that is killed again and again miss nothing")
{
    Middle line("sleeper");
    const auto second = line.swarm.drone("sleeper", "x2", {"work_ms=4"});
    line.of_x = line.application.collect({{"x", "result"}, {"x2", "result"}}, in_order);
    line.application.connect({"middle", "result"}, {"x", "image"}, member_of("workers"));
    line.application.connect({"middle", "result"}, {"x2", "image"}, member_of("workers"));
    line.application.connect({"middle", "result"}, {"y", "image"});
    line.run([&] { line.kill_and_start("sleeper"); });
}

TEST_CASE("returning: each event of a drone that throws and is replaced gives a result or an exception, once")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=" + std::to_string(emitted)});
    const auto worker = swarm.drone("sleeper", "worker", {"work_ms=2", "throw_every=2"});
    auto application = swarm.application();
    const auto results = application.collect({{"worker", "result"}}),
               exceptions = application.collect({{"worker", "exceptions"}});
    application.connect({"source", "tick"}, {"worker", "image"});
    Sequences came;
    // From both as they come: what is repeated after a replace fills the window of one that is not taken from.
    const auto take_from_both = [&](std::ptrdiff_t count) {
        return eventually([&] {
            for (auto* collector : {results.get(), exceptions.get()})
                std::ranges::copy(take(*collector, 1, 10ms), std::back_inserter(came));
            return std::ssize(came) >= count;
        });
    };
    for (int i = 1; i <= 8; ++i) {
        REQUIRE(take_from_both(16 * i));
        swarm.hivectl_done({"replace", "worker"}, 60s);
    }
    CHECK(take_from_both(emitted));
    CHECK(rest(*results) + rest(*exceptions) == 0);
    CHECK(listed(sorted(came)) == listed(one_to(emitted)));
}

TEST_CASE("returning: an application that has ended meanwhile is not waited for")
{
    Middle line("sleeper");
    line.application.connect({"middle", "result"}, {"x", "image"});
    line.application.connect({"middle", "result"}, {"y", "image"});
    auto listener = line.swarm.hivectl_running({"exceptions", "middle", "--follow"}, "listener");
    REQUIRE(eventually([&] { return connected_edges(line.application.status("middle").outputs.back()) == 1; }));
    line.middle.kill();
    listener.kill();
    line.middle = line.swarm.drone("sleeper", "middle");
    line.run([] {});
}

TEST_CASE("returning: a source that expects two receivers waits for both, or until nobody waits for the second")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=20"},
                                    {"--expect", "x.image", "--expect", "tick=y.image", "--expect", "never.image"});
    const auto x = swarm.drone("sleeper", "x", {}, {"--connect", "source.tick"});
    const auto y = swarm.drone("sleeper", "y");
    auto application = swarm.application();
    const auto of_x = application.collect({{"x", "result"}}), of_y = application.collect({{"y", "result"}});
    CHECK(rest(*of_x) == 0);
    application.connect({"source", "tick"}, {"y", "image"});
    CHECK(rest(*of_x) == 0);
    CHECK(application.status("source").outputs.at(0).why == hive::Reason::place_kept);
    application.disconnect({"source", "tick"}, {"never", "image"});
    CHECK(listed(take(*of_x, 20)) == listed(one_to(20)));
    CHECK(listed(take(*of_y, 20)) == listed(one_to(20)));
}
