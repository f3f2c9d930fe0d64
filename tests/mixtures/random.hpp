// Chance that is the same on every machine: the distributions of the standard library are not.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace hive::mixtures {

class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    /// Both included.
    int between(int least, int most)
    {
        return least + static_cast<int>(engine_() % static_cast<std::uint64_t>(most - least + 1));
    }
    bool chance(int percent) { return between(1, 100) <= percent; }
    template <class Item>
    Item pick(const std::vector<Item>& items)
    {
        return items.at(static_cast<std::size_t>(between(0, static_cast<int>(items.size()) - 1)));
    }

private:
    std::mt19937_64 engine_;  // its numbers are fixed by the standard
};

}  // namespace hive::mixtures
