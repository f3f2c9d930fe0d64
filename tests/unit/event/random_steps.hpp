// Many random steps of which each must leave the promises kept. A failure prints the seed and a shorter list of steps
// that fails as well. HIVE_TEST_SEED=... repeats a walk, HIVE_TEST_KEPT="3 17" only these steps of it, and
// HIVE_TEST_STEPS=... sets its length.
#pragma once

#include "fixtures.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <iterator>
#include <numeric>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>

namespace hive::event::random {

class Dice {
public:
    explicit Dice(std::uint64_t seed) : seed_(seed), state_(seed) {}
    /// What a step throws does not depend on the steps before it.
    void begin(std::uint64_t step) { state_ = seed_ ^ (step * 0xd1342543de82ef95); }
    /// From `least` to `most`, each as likely.
    std::int64_t between(std::int64_t least, std::int64_t most)
    {
        return least + static_cast<std::int64_t>(thrown() % static_cast<std::uint64_t>(most - least + 1));
    }
    /// Yes, `percent` times of a hundred.
    bool yes(int percent) { return between(1, 100) <= percent; }
    /// The place of one of them.
    template <class Container>
    auto one_of(Container& container)
    {
        return std::next(container.begin(), between(0, std::ssize(container) - 1));
    }

private:
    /// SplitMix64: it is cheap to seed.
    std::uint64_t thrown()
    {
        auto mixed = state_ += 0x9e3779b97f4a7c15;
        mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9;
        mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111eb;
        return mixed ^ (mixed >> 31);
    }

    std::uint64_t seed_, state_;
};

/// A promise: when it is broken the walk ends.
inline void hold(bool kept, const char* promise)
{
    if (!kept)
        throw std::logic_error(promise);
}

inline std::uint64_t number_from(const char* variable, std::uint64_t otherwise)
{
    const char* text = std::getenv(variable);
    return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

struct Broken {
    std::uint64_t step;
    std::string promise;
};
using Steps = std::vector<std::uint64_t>;

template <class Make>
std::optional<Broken> walked(std::uint64_t seed, const Steps& steps, Make make)
{
    Dice dice(seed);
    auto world = make(dice);
    for (const auto step : steps)
        try {
            dice.begin(step);
            world.step();
            world.check();
        } catch (const std::logic_error& broken) {
            return Broken{step, broken.what()};
        }
    return std::nullopt;
}

/// Leaves out steps as long as the same promise is broken.
template <class Make>
Steps shrunk(std::uint64_t seed, Steps steps, const Broken& broken, Make make)
{
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    steps.erase(std::ranges::upper_bound(steps, broken.step), steps.end());
    for (auto size = std::ssize(steps) / 2; size > 0;) {
        const auto before = std::ssize(steps);
        for (std::ptrdiff_t at = 0; at < std::ssize(steps) && std::chrono::steady_clock::now() < until;) {
            Steps fewer = steps;
            fewer.erase(fewer.begin() + at, fewer.begin() + std::min(at + size, std::ssize(fewer)));
            const auto again = walked(seed, fewer, make);
            if (!again || again->promise != broken.promise) {
                at += size;
                continue;
            }
            fewer.erase(std::ranges::upper_bound(fewer, again->step), fewer.end());
            steps = std::move(fewer);
        }
        if (size > 1 || std::ssize(steps) == before)
            size /= 2;
    }
    return steps;
}

inline std::string text_of(const Steps& steps)
{
    std::ostringstream text;
    for (const auto step : steps)
        text << step << " ";
    return text.str();
}

/// Takes `count` random steps in a world made by `make`, which has step() and check().
template <class Make>
void walk(std::uint64_t count, Make make)
{
    const auto seed = number_from("HIVE_TEST_SEED", std::random_device()());
    MESSAGE("HIVE_TEST_SEED=", seed);
    if (const char* kept = std::getenv("HIVE_TEST_KEPT")) {
        std::istringstream text(kept);
        const auto broken = walked(seed, {std::istream_iterator<std::uint64_t>(text), {}}, make);
        REQUIRE_MESSAGE(!broken, "in step ", broken->step, ": ", broken->promise);
        return;
    }
    Steps steps(number_from("HIVE_TEST_STEPS", count));
    std::iota(steps.begin(), steps.end(), 1);
    if (const auto broken = walked(seed, steps, make))
        FAIL("HIVE_TEST_SEED=", seed, ": in step ", broken->step, ": ", broken->promise,
             "; also with HIVE_TEST_KEPT=\"", text_of(shrunk(seed, steps, *broken, make)), "\"");
}

/// Most are small, some fill the lane, few are larger than all queues.
inline EmissionPtr any_emission(Dice& dice, std::int64_t sequence, bool lossless)
{
    static const std::array bodies{Body(std::vector<unsigned char>(10)), Body(std::vector<unsigned char>(20'000)),
                                   Body(std::vector<unsigned char>(70'000)),
                                   Body(std::vector<unsigned char>(Subscription::max_queued_bytes))};
    const auto size = dice.yes(80) ? 0 : dice.yes(70) ? 1 : dice.yes(70) ? 2 : 3;
    Event event = emission(sequence, lossless, 0)->event();
    event.body = bodies[static_cast<std::size_t>(size)];
    std::optional<Share> own;
    if (lossless)
        own = Share{.of = "camera.image", .epoch = 1, .turn = sequence};
    return std::make_shared<const Emission>(std::move(event), true, own);
}

/// What a receiver says; some lie.
inline Progress any_progress(Dice& dice, const Progress& known, std::int64_t sent, int window)
{
    if (dice.yes(5))
        return {dice.between(-5, sent + 99), dice.between(-5, sent + 99), dice.between(-5, sent + 99)};
    Progress told;
    told.worked = dice.between(known.worked, sent);
    told.done = dice.between(known.done, told.worked);
    told.asked = dice.yes(80) ? told.worked + window : known.asked;
    return told;
}

/// How far a receiver is that is sent `sent` deliveries and tells this.
inline void take_over(Progress& known, const Progress& told, std::int64_t sent, int window)
{
    known.asked = std::max(known.asked, std::min(told.asked, sent + window));
    known.done = std::max(known.done, std::min(told.done, sent));
    known.worked = std::max(known.worked, std::min(std::max(told.worked, known.done), sent));
}

/// What a connection was given and has not yet taken.
class Lane {
public:
    void sent(std::size_t bytes)
    {
        sizes_.push_back(bytes);
        bytes_ += bytes;
        hold(sizes_.size() <= Credit::most_lane_events, "a lane has 64 events at most");
        hold(sizes_.size() == 1 || bytes_ <= Credit::lane_bytes, "a lane has one event or 64 KiB at most");
    }
    [[nodiscard]] bool empty() const { return sizes_.empty(); }
    std::size_t written()
    {
        const auto bytes = sizes_.front();
        sizes_.pop_front();
        bytes_ -= bytes;
        return bytes;
    }
    [[nodiscard]] bool free(std::size_t bytes) const
    {
        return sizes_.empty() || (sizes_.size() < Credit::most_lane_events && bytes_ + bytes <= Credit::lane_bytes);
    }

private:
    std::deque<std::size_t> sizes_;
    std::size_t bytes_ = 0;
};

inline Fate any_loss(Dice& dice)
{
    return std::array{Fate::lost_connection, Fate::lost_killed,
                      Fate::lost_cut_off}[static_cast<std::size_t>(dice.between(0, 2))];
}

}  // namespace hive::event::random
