#include "extras.hpp"
#include "plan.hpp"
#include "random.hpp"

namespace hive::mixtures {

Extras make_extras(std::uint64_t seed)
{
    Random random(~seed);  // the plan has drawn from the seed itself
    const bool ends = random.chance(30);
    const bool command = random.chance(60) && !ends;  // it exits at the end
    Extras extras{.ends = ends, .command = command};
    if (random.chance(40))
        extras.bystanders.push_back(recorder);
    if (random.chance(40))
        extras.bystanders.push_back(forker);
    extras.up = random.chance(30);
    return extras;
}

std::string to_text(const Extras& extras)
{
    std::string text = extras.ends ? "the source ends" : "the source does not end";
    if (extras.up)
        text += ", up and down";
    if (extras.command)
        text += ", -> hivectl results";
    for (const auto& drone : extras.bystanders)
        text += ", source -> " + drone;
    return text;
}

}  // namespace hive::mixtures
