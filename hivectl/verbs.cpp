// Makes the list of verbs and finds one in it.
#include "verbs.hpp"

#include <algorithm>

namespace hivectl {

std::vector<Verb> verbs()
{
#define HIVECTL_CALL(name) name##_verb::verb(),
    return {HIVECTL_VERBS(HIVECTL_CALL)};
#undef HIVECTL_CALL
}

const Verb* verb_named(const std::vector<Verb>& all, std::string_view name)
{
    const auto found = std::ranges::find_if(
        all, [&](const Verb& verb) { return verb.name == name || (!name.empty() && verb.alias == name); });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace hivectl
