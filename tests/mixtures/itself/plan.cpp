// A plan follows from its seed, makes sense at every step, and ends with everything mended.
#include "../plan.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>

using namespace hive::mixtures;

namespace {

std::string text_of(const Plan& plan)
{
    auto text = to_text(plan.topology);
    for (const auto& step : plan.steps)
        text += "\n" + to_text(step);
    return text;
}

/// Follows what is broken, in words of its own.
class Follower {
public:
    explicit Follower(const Topology& topology)
    {
        for (const auto& edge : topology.edges())
            edges_.insert({edge.sender, edge.receiver});
        all_ = edges_;
    }

    void follow(const Step& step)
    {
        const auto was = state_[step.drone];
        switch (step.verb) {
        case Verb::feed: REQUIRE((was.empty() || was == "halted")); break;
        case Verb::kill:
        case Verb::set_and_kill: become(step.drone, "killed", {"", "halted"}); break;
        case Verb::start: become(step.drone, "", {"killed", "stopped"}); break;
        case Verb::freeze: become(step.drone, "frozen", {""}); break;
        case Verb::thaw: become(step.drone, "", {"frozen"}); break;
        case Verb::halt: become(step.drone, "halted", {""}); break;
        case Verb::resume: become(step.drone, "", {"halted"}); break;
        case Verb::connect: REQUIRE(edges_.insert({step.sender, step.drone}).second); break;
        case Verb::disconnect: REQUIRE(edges_.erase({step.sender, step.drone}) == 1); break;
        case Verb::stop:
            become(step.drone, "stopped", {""});
            std::erase_if(edges_, [&](const auto& edge) { return edge.second == step.drone; });
            break;
        default: break;
        }
        used_.insert(step.verb);
    }

    void end() const
    {
        for (const auto& [drone, state] : state_)
            REQUIRE_MESSAGE(state == "", drone);
        REQUIRE(edges_ == all_);
    }
    [[nodiscard]] const std::set<Verb>& used() const { return used_; }

private:
    void become(const std::string& drone, const std::string& state, const std::set<std::string>& from)
    {
        REQUIRE(from.contains(state_[drone]));
        state_[drone] = state;
    }

    std::map<std::string, std::string> state_;
    std::set<std::pair<std::string, std::string>> edges_, all_;
    std::set<Verb> used_;
};

}  // namespace

TEST_CASE("mixtures: a plan is a function of its seed")
{
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        CHECK(text_of(make_plan(seed, 20)) == text_of(make_plan(seed, 20)));
        CHECK(text_of(make_plan(seed, 20)) != text_of(make_plan(seed + 1, 20)));
    }
}

TEST_CASE("mixtures: a seed means the same everywhere and always")
{
    CHECK(text_of(make_plan(3, 4))
          == R"(source on demand -> a1 a2 (window 3, shared, lease 4000 ms) -> collected in order
feed source 24
change source and a1 1, then check
kill source, then check
set one a1 10 9, then check
start source
feed source 39
rest, then check)");
}

TEST_CASE("mixtures: every step of a plan can be done where it stands, and at the end nothing is broken")
{
    std::set<Verb> used;
    for (std::uint64_t seed = 0; seed < 3000; ++seed) {
        const auto plan = make_plan(seed, 20);
        REQUIRE(plan.topology.drones().size() >= 2);
        REQUIRE(plan.topology.drones().size() <= 6);
        Follower follower(plan.topology);
        for (const auto& step : plan.steps)
            follower.follow(step);
        follower.end();
        REQUIRE(plan.steps.back().settle);
        used.insert(follower.used().begin(), follower.used().end());
    }
    CHECK(used.size() == static_cast<std::size_t>(Verb::rest) + 1);
}

TEST_CASE("mixtures: two die, the receiver while it works or soon after, and all that follows makes sense")
{
    std::size_t lingering = 0;
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        const auto plan = make_plan(seed, 20, {fault::two_die});
        Follower follower(plan.topology);
        for (auto step = plan.steps.begin(); step != plan.steps.end(); ++step) {
            follower.follow(*step);
            if (step->verb != Verb::fail)
                continue;
            ++lingering;
            REQUIRE(step->second == static_cast<int>(Failure::lingers));
            const auto dies = [&](const Step& later) { return later.verb == Verb::kill && later.drone == step->drone; };
            const auto death = std::find_if(step, plan.steps.end(), dies);
            REQUIRE(death != plan.steps.end());
            const auto senders = [&](const Step& later) {
                return later.verb == Verb::kill && std::ranges::any_of(plan.topology.edges(), [&](const Edge& edge) {
                           return edge.sender == later.drone && edge.receiver == step->drone;
                       });
            };
            REQUIRE(std::count_if(step, death, senders) == 1);
        }
        follower.end();
    }
    CHECK(lingering > 500);
}

TEST_CASE("mixtures: each seed draws its faults, and many draw none")
{
    std::map<std::size_t, int> seeds;
    std::set<std::string> used;
    for (std::uint64_t seed = 0; seed < 1000; ++seed) {
        const auto drawn = draw_faults(seed, fault::all);
        CHECK(drawn == draw_faults(seed, fault::all));
        ++seeds[drawn.contains(fault::none) ? 0 : drawn.size()];
        used.insert(drawn.begin(), drawn.end());
    }
    CHECK(used.size() == fault::all.size() + 1);
    CHECK(seeds[0] > 300);
    CHECK(seeds[1] > 60);
    CHECK(seeds[6] > 30);
    CHECK(draw_faults(1, {}).empty());
}
