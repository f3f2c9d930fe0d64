// Checks, assigns and reports groups of parameters.
#include "parameter_set.hpp"

#include <hive/error.hpp>
#include <hive/name.hpp>

#include <algorithm>

namespace hive {

const ParameterInfo& ParameterSet::find(const std::string& name) const
{
    const auto found = std::ranges::find(declared_, name, &ParameterInfo::name);
    if (found != declared_.end())
        return *found;
    std::vector<std::string> names;
    for (const auto& parameter : declared_)
        names.push_back(parameter.name);
    throw no_such("no parameter " + in_quotes(name), name, names);
}

Json ParameterSet::checked(const Json& wanted) const
{
    Json values = Json::object();
    for (const auto& [name, value] : wanted.items())
        values[name] = checked_value(find(name), value);
    return values;
}

void ParameterSet::assign(const Json& checked_values)
{
    for (const auto& [name, value] : checked_values.items())
        assign_.at(name)(value);
}

void ParameterSet::require_tellable() const
{
    constexpr std::size_t most_bytes = 48 * 1024;  // so that they fit into one header, with its other fields
    std::size_t bytes = 0;
    for (const auto& [name, read] : read_) {
        const Json value = read();
        require_within(value);
        bytes += name.size() + to_text(value).size();
    }
    require_at_most("all parameters together", bytes, most_bytes);
}

Json ParameterSet::assigned(const Json& wanted) const
{
    Json values = Json::object();
    for (const auto& [name, value] : wanted.items())
        values[name] = read_.at(name)();
    return values;
}

void ParameterSet::read_back(const Json& checked_values)
{
    constexpr std::size_t most_bytes = 8 * 1024;  // reported instead of values, which have their own limit
    const std::lock_guard lock(mutex_);
    for (const auto& [name, read] : read_)
        if (auto now = read(); values_[name] != now) {
            values_[name] = std::move(now);
            asked_.erase(name);
        }
    for (const auto& [name, value] : checked_values.items())
        if (values_.at(name) != value)
            asked_[name] = value;
        else
            asked_.erase(name);
    if (to_text(asked_).size() > most_bytes)
        asked_.clear();
}

Json ParameterSet::values(const std::vector<std::string>& names) const
{
    const std::lock_guard lock(mutex_);
    if (names.empty())
        return values_;
    Json some = Json::object();
    for (const auto& name : names)
        some[name] = values_.at(find(name).name);
    return some;
}

Json ParameterSet::asked(const std::vector<std::string>& names) const
{
    Json some = values(names);
    const std::lock_guard lock(mutex_);
    for (const auto& [name, value] : asked_.items())
        if (some.contains(name))
            some[name] = value;
    return some;
}

Json ParameterSet::changed() const
{
    Json some = asked();
    for (const auto& parameter : declared_)
        if (some.at(parameter.name) == parameter.default_value)
            some.erase(parameter.name);
    return some;
}

}  // namespace hive
