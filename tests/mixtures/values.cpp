// Which values the workers' parameters may have: a list of whole states, narrowed by what is told and found.
#include "values.hpp"

#include <algorithm>

namespace hive::mixtures {
namespace {

Settings with(Settings settings, const Change& change)
{
    for (const auto& drone : change.drones) {
        auto& setting = settings[drone];
        setting.work_ms = change.work_ms;
        setting.most_ms = change.most_ms.value_or(setting.most_ms);
    }
    return settings;
}

bool fits(const Settings& settings, const Change& change)
{
    const auto changed = with(settings, change);
    return std::ranges::all_of(
        change.drones, [&](const auto& drone) { return changed.at(drone).work_ms <= changed.at(drone).most_ms; });
}

void apply(std::set<Settings>& states, const Change& change, Told told)
{
    std::set<Settings> after;
    for (const auto& state : states) {
        if (told != Told::refused && fits(state, change))
            after.insert(with(state, change));
        if (told != Told::applied)
            after.insert(state);
    }
    states = std::move(after);
}

std::string words(const Settings& settings)
{
    std::string text;
    for (const auto& [drone, setting] : settings)
        text += (text.empty() ? "" : ", ") + drone + " " + std::to_string(setting.work_ms) + "/"
                + std::to_string(setting.most_ms);
    return text;
}

std::string words(const std::set<Settings>& states)
{
    std::string text;
    for (const auto& state : states)
        text += (text.empty() ? "" : "; or ") + words(state);
    return text;
}

}  // namespace

void Values::began(const std::string& drone, Setting setting)
{
    std::set<Settings> begun;
    for (auto state : possible_) {
        state[drone] = setting;
        begun.insert(std::move(state));
    }
    possible_ = std::move(begun);
}

std::optional<std::string> Values::set(const Change& change, Told told, const std::string& killed)
{
    const auto before = possible_;
    const auto fitting = std::ranges::count_if(before, [&](const auto& state) { return fits(state, change); });
    if (killed.empty() && told == Told::refused && fitting == std::ssize(before))
        return "all or nothing: a set was refused that every drone can take";
    apply(possible_, change, told);
    if (possible_.empty()) {
        possible_ = before;
        return "all or nothing: a set was confirmed that a drone cannot take";
    }
    if (killed.empty())
        return std::nullopt;
    std::set<Setting> values;
    for (const auto& old : before)
        values.insert({old.at(killed), with(old, change).at(killed)});
    for (const auto& state : std::set(possible_))
        for (const auto& value : values) {
            auto other = state;
            other[killed] = value;
            possible_.insert(std::move(other));
        }
    return std::nullopt;
}

void Values::set_both(const Change& one, Told told_one, const Change& other, Told told_other)
{
    auto other_first = possible_;
    apply(possible_, one, told_one);
    apply(possible_, other, told_other);
    apply(other_first, other, told_other);
    apply(other_first, one, told_one);
    possible_.merge(other_first);
}

std::optional<std::string> Values::found(const Settings& actual)
{
    auto agreeing = possible_;
    std::erase_if(agreeing, [&](const Settings& state) {
        return !std::ranges::all_of(actual, [&](const auto& entry) { return state.at(entry.first) == entry.second; });
    });
    if (!agreeing.empty()) {
        possible_ = std::move(agreeing);
        return std::nullopt;
    }
    const auto expected = words(possible_);
    for (const auto& [drone, setting] : actual)
        began(drone, setting);
    return "all or nothing: work_ms/most_ms are " + words(actual) + "; expected " + expected;
}

}  // namespace hive::mixtures
