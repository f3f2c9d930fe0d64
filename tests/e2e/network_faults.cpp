// Networks that fail during work, and recover. Slow, because each failure must be detected first.
#include "bad_link.hpp"
#include "lab.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <algorithm>
#include <functional>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// A source on demand on one machine, a worker on the next, and its results on the laptop; all with a key.
class Chain {
public:
    explicit Chain(const std::vector<std::string>& variables = {}) : lab_({"cam1", "gpu1"}, variables)
    {
        lab_.share_key();
        lab_.hivectl_done("start ticker --on cam1 pace=demand ends=true");
        lab_.hivectl_done("start sleeper --on gpu1 work_ms=10");
        results_.emplace(lab_.hivectl_running("results sleeper", "results"));
        REQUIRE(eventually([&] { return !application_.status("sleeper").outputs.at(0).edges.empty(); }));
        lab_.hivectl_done("connect ticker sleeper");
    }

    [[nodiscard]] const Lab& lab() const { return lab_; }
    [[nodiscard]] hive::InputStatus input() { return application_.status("sleeper").inputs.at(0); }

    /// Breaks the network between the two during work until that is detected. Returns the time until detection, and
    /// from the repair until the reconnection.
    std::pair<Seconds, Seconds> survive(const std::function<void()>& breaks, const std::function<void()>& mends)
    {
        const auto before = input().received;
        REQUIRE(eventually([&] { return input().received >= before + 10; }));
        breaks();
        const auto broken = Clock::now();
        REQUIRE(eventually([&] { return !input().connected; }, 5000ms));
        const Seconds noticed = Clock::now() - broken;
        mends();
        const auto mended = Clock::now();
        REQUIRE(eventually([&] { return input().connected; }, 10'000ms));
        return {noticed, Clock::now() - mended};
    }

    /// The number of events of the source.
    [[nodiscard]] std::int64_t given() { return at_source_.status("ticker").outputs.at(0).produced; }

    /// Numbers of the events with results once the source has ended, which is soon.
    std::vector<std::int64_t> finished()
    {
        lab_.hivectl_done("set ticker count=" + std::to_string(given() + 50));
        CHECK(results_->wait(patient(40'000ms)) == 0);
        std::istringstream lines(text_of(lab_.directory() / "results.log"));
        std::vector<std::int64_t> numbers;
        for (std::string line; std::getline(lines, line);)
            if (line.starts_with('{'))
                numbers.push_back(Json::parse(line).at("header").at("index").get<std::int64_t>());
        return numbers;
    }

private:
    Lab lab_;
    hive::Application application_{lab_.machine(1).swarm.application()},
        at_source_{lab_.machine(0).swarm.application()};
    std::optional<Process> results_;
};

/// Nearly all took less than the promised time: each stall of the machine may have affected one.
void check_most(std::vector<double> seconds, Milliseconds promised)
{
    std::ranges::sort(seconds);
    const auto others = std::max<std::size_t>(1, seconds.size() / 10);
    CHECK(seconds.at(seconds.size() - 1 - others) < Seconds(promised).count());
    CHECK(seconds.back() < Seconds(patient(10'000ms)).count());
}

/// Breaks the network repeatedly: each time the break and the repair are detected in time.
void check_survives(Chain& chain, int times, const std::function<void()>& breaks, const std::function<void()>& mends)
{
    std::vector<double> noticed, back;
    for (int i = 0; i < times; ++i) {
        const auto took = chain.survive(breaks, mends);
        noticed.push_back(took.first.count());
        back.push_back(took.second.count());
    }
    MESSAGE("noticed after at most " << std::ranges::max(noticed) << " s, mended after at most "
                                     << std::ranges::max(back) << " s");
    check_most(noticed, stated(2500ms));
    check_most(back, stated(1000ms));
}

void check_each_once(Chain& chain)
{
    const auto numbers = chain.finished();
    CHECK(static_cast<std::int64_t>(numbers.size()) == chain.given());
    CHECK(std::ranges::adjacent_find(numbers, std::greater_equal()) == numbers.end());
}

}  // namespace

TEST_CASE("network: partitions are noticed and mended in time, and of a source on demand nothing is lost or twice")
{
    if (!possible(missing_for_lab()))
        return;
    constexpr int partitions = sanitized() ? 5 : 20;
    Chain chain;
    check_survives(
        chain, partitions, [&] { chain.lab().cut(0); }, [&] { chain.lab().mend(0); });
    check_each_once(chain);
}

TEST_CASE("network: a black hole, which tells nobody, is noticed and left behind in time, and nothing is lost or twice")
{
    if (!possible(missing_for_lab()))
        return;
    constexpr int holes = 6;
    constexpr LineQuality good{.delay = 5ms};
    Chain chain;
    BadLink link(chain.lab().machine(0), chain.lab().machine(1), good);
    check_survives(
        chain, holes, [&] { link.swallow(); }, [&] { link.set(good); });
    check_each_once(chain);
}

TEST_CASE("network: when heartbeats are not waited for, a black hole is not noticed in twice the time")
{
    if (!possible(missing_for_lab()))
        return;
    Chain chain({"HIVE_TEST_WITHOUT=heartbeats"});
    BadLink link(chain.lab().machine(0), chain.lab().machine(1), {.delay = 5ms});
    REQUIRE(eventually([&] { return chain.input().received >= 10; }));
    link.swallow();
    std::this_thread::sleep_for(5s);  // this is the measurement
    CHECK(chain.input().connected);
}

TEST_CASE("network: what vanishes on the way to a receiver that is still heard comes again")
{
    if (!possible(missing_for_lab()))
        return;
    Chain chain;
    std::vector<double> noticed;
    for (int i = 0; i < 3; ++i) {
        const auto took = chain.survive([&] { chain.lab().swallow(0, 1); }, [&] { chain.lab().let_through(0, 1); });
        MESSAGE("noticed after " << took.first.count() << " s, mended after " << took.second.count() << " s");
        noticed.push_back(took.first.count());
    }
    check_most(noticed, stated(2500ms));
    check_each_once(chain);
}

TEST_CASE("network: when places are not kept, what vanishes on the way is lost")
{
    if (!possible(missing_for_lab()))
        return;
    Chain chain({"HIVE_TEST_WITHOUT=places"});
    for (int i = 0; i < 3; ++i)
        chain.survive([&] { chain.lab().swallow(0, 1); }, [&] { chain.lab().let_through(0, 1); });
    const auto came = static_cast<std::int64_t>(chain.finished().size());
    CHECK(came < chain.given());
}
