// From a seed to what is beside the plan.
#include "extras.hpp"
#include "random.hpp"

namespace hive::mixtures {

Extras make_extras(std::uint64_t seed)
{
    Random random(~seed);  // the plan has drawn from the seed itself
    const bool ends = random.chance(30);
    const bool command = random.chance(60) && !ends;  // it exits at the end
    return {.ends = ends, .command = command};
}

std::string to_text(const Extras& extras)
{
    std::string text = extras.ends ? "the source ends" : "the source does not end";
    if (extras.command)
        text += ", -> hivectl results";
    return text;
}

}  // namespace hive::mixtures
