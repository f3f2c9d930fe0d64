// Many random steps of which each must leave the promises kept. A failure names the seed; HIVE_TEST_SEED=... walks the
// same way again, HIVE_TEST_STEPS=... a longer one.
#pragma once

#include "fixtures.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstdlib>
#include <random>
#include <stdexcept>

namespace hive::event::random {

class Dice {
public:
    explicit Dice(std::uint64_t seed) : engine_(seed) {}
    /// From `least` to `most`, each as likely.
    std::int64_t between(std::int64_t least, std::int64_t most)
    {
        return least + static_cast<std::int64_t>(engine_() % static_cast<std::uint64_t>(most - least + 1));
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
    std::mt19937_64 engine_;
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

/// Takes `steps` random steps in a world made by `make`, which has step() and check().
template <class Make>
void walk(std::uint64_t steps, Make make)
{
    const auto seed = number_from("HIVE_TEST_SEED", std::random_device()());
    Dice dice(seed);
    auto world = make(dice);
    MESSAGE("HIVE_TEST_SEED=", seed);
    for (std::uint64_t step = 1; step <= number_from("HIVE_TEST_STEPS", steps); ++step)
        try {
            world.step();
            world.check();
        } catch (const std::logic_error& broken) {
            FAIL("HIVE_TEST_SEED=", seed, ": in step ", step, ": ", std::string(broken.what()));
        }
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
