// The parameters of one drone: bound to the author's variables, checked, applied together or not at all.
#pragma once

#include <hive/interface.hpp>

#include <functional>
#include <mutex>
#include <vector>

namespace hive {

/// Declared before the drone runs; then apply() is for the user thread, the rest for any.
class ParameterSet {
public:
    template <class Value>
    void add(ParameterInfo parameter, Value& variable)
    {
        parameter.default_value = variable;
        (void)checked_value(parameter,
                            parameter.default_value);  // a default outside its own range is the author's mistake
        values_[parameter.name] = parameter.default_value;
        assign_[parameter.name] = [&variable](const Json& value) { variable = value.get<Value>(); };
        read_[parameter.name] = [&variable] { return Json(variable); };
        declared_.push_back(std::move(parameter));
    }

    [[nodiscard]] const std::vector<ParameterInfo>& declared() const noexcept { return declared_; }
    /// The values that `wanted` stands for. Throws Errc::not_found (with the nearest name) or Errc::refused.
    [[nodiscard]] Json checked(const Json& wanted) const;
    /// Assigns checked values, calls `accept`, and takes what the variables hold then for what was applied. If `accept`
    /// throws, the old values are back, it was called again, and it throws on.
    void apply(const Json& checked_values, const std::function<void()>& accept);
    /// What the variables hold now is what is told from now on.
    void read_back();
    /// All, or those named. Throws Errc::not_found.
    [[nodiscard]] Json values(const std::vector<std::string>& names = {}) const;
    /// The values that differ from the defaults.
    [[nodiscard]] Json changed() const;

private:
    void assign(const Json& values);
    [[nodiscard]] const ParameterInfo& find(const std::string& name) const;

    std::vector<ParameterInfo> declared_;
    std::map<std::string, std::function<void(const Json&)>> assign_;
    std::map<std::string, std::function<Json()>> read_;
    mutable std::mutex mutex_;
    Json values_ = Json::object();
};

}  // namespace hive
