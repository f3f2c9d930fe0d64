// From a seed to what is beside the plan.
#include "extras.hpp"
#include "random.hpp"

namespace hive::mixtures {

Extras make_extras(std::uint64_t seed)
{
    Random random(~seed);  // the plan has drawn from the seed itself
    return {.command = random.chance(60)};
}

std::string to_text(const Extras& extras)
{
    std::string text;
    if (extras.command)
        text += " -> hivectl results";
    return text;
}

}  // namespace hive::mixtures
