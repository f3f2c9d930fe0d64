// Networks that fail in the middle of work, and come back. Slow, since each failure has to be noticed first.
#include "lab.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

using Seconds = std::chrono::duration<double>;

bool possible()
{
    const auto what = missing_for_lab();
    if (!what.empty())
        MESSAGE("left out: it needs " << what);
    return what.empty();
}

/// A source on demand on one machine, a worker on the next, and its results on the laptop; all behind a key.
class Chain {
public:
    explicit Chain(std::int64_t events, const std::vector<std::string>& variables = {})
        : lab_({"cam1", "gpu1"}, variables)
    {
        lab_.share_key();
        lab_.hivectl_done("start ticker --on cam1 pace=demand ends=true count=" + std::to_string(events));
        lab_.hivectl_done("start sleeper --on gpu1 work_ms=10");
        results_.emplace(lab_.hivectl_running("results sleeper", "results"));
        REQUIRE(eventually([&] { return !application_.status("sleeper").outputs.at(0).edges.empty(); }));
        lab_.hivectl_done("connect ticker sleeper");
    }

    [[nodiscard]] const Lab& lab() const { return lab_; }
    [[nodiscard]] hive::InputStatus input() { return application_.status("sleeper").inputs.at(0); }

    /// Breaks the network between the two in the middle of work until that is noticed. Returns how long it took to be
    /// noticed, and from the mending on until there was a connection again.
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

    /// Numbers of the events whose results came, when the source has come to its end.
    std::vector<std::int64_t> finished()
    {
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
    hive::Application application_{lab_.machine(1).swarm.application()};
    std::optional<Process> results_;
};

void check_each_once(const std::vector<std::int64_t>& numbers, std::int64_t events)
{
    CHECK(static_cast<std::int64_t>(numbers.size()) == events);
    CHECK(std::ranges::adjacent_find(numbers, std::greater_equal()) == numbers.end());
}

}  // namespace

TEST_CASE("network: partitions are noticed and mended in time, and of a source on demand nothing is lost or twice")
{
    if (!possible())
        return;
    constexpr int partitions = sanitized() ? 5 : 20;
    constexpr std::int64_t events = 100 + 40 * partitions;
    Chain chain(events);
    std::vector<double> noticed, back;
    for (int i = 0; i < partitions; ++i) {
        const auto took = chain.survive([&] { chain.lab().cut(0); }, [&] { chain.lab().mend(0); });
        noticed.push_back(took.first.count());
        back.push_back(took.second.count());
    }
    MESSAGE("noticed after at most " << std::ranges::max(noticed) << " s, mended after at most "
                                     << std::ranges::max(back) << " s");
    CHECK(std::ranges::max(noticed) < Seconds(patient(2500ms)).count());
    CHECK(std::ranges::max(back) < Seconds(patient(1000ms)).count());
    check_each_once(chain.finished(), events);
}

TEST_CASE("network: what vanishes on the way to a receiver that is still heard comes again")
{
    if (!possible())
        return;
    Chain chain(200);
    for (int i = 0; i < 3; ++i) {
        const auto took = chain.survive([&] { chain.lab().swallow(0, 1); }, [&] { chain.lab().let_through(0, 1); });
        MESSAGE("noticed after " << took.first.count() << " s, mended after " << took.second.count() << " s");
        CHECK(took.first < patient(2500ms));
    }
    check_each_once(chain.finished(), 200);
}

TEST_CASE("network: when places are not kept, what vanishes on the way is lost")
{
    if (!possible())
        return;
    Chain chain(100, {"HIVE_TEST_NO_PLACES=1"});
    chain.survive([&] { chain.lab().swallow(0, 1); }, [&] { chain.lab().let_through(0, 1); });
    CHECK(chain.finished().size() < 100);
}
