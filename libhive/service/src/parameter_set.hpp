// The parameters of one drone: bound to the author's variables, checked, and told to whoever asks.
#pragma once

#include <hive/interface.hpp>

#include <functional>
#include <mutex>
#include <vector>

namespace hive {

/// Declared before the drone runs. The variables belong to the user thread; what is told of them is for any.
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
    /// The user thread. Gives checked values to the variables; what is told stays as it was until read_back().
    void assign(const Json& checked_values);
    /// The user thread. What the variables hold now is what is told from now on.
    /// @param checked_values  what they were given before the drone's code made of them what they are
    void read_back(const Json& checked_values);
    /// The user thread. The variables hold again what is told.
    void put_back() { assign(values()); }
    /// The user thread. What the variables hold of the parameters that `wanted` names.
    [[nodiscard]] Json assigned(const Json& wanted) const;
    /// Throws Errc::too_large when the drone's code has made something of its variables that cannot be told: over the
    /// limits of a header, and of the file that outlives a crash.
    void require_tellable() const;
    /// All, or those named. Throws Errc::not_found.
    [[nodiscard]] Json values(const std::vector<std::string>& names = {}) const;
    /// The same as they were asked for: the drone's code may have made another value of one, for example by rounding.
    [[nodiscard]] Json asked(const std::vector<std::string>& names = {}) const;
    /// What was asked for that is not the default.
    [[nodiscard]] Json changed() const;

private:
    [[nodiscard]] const ParameterInfo& find(const std::string& name) const;

    std::vector<ParameterInfo> declared_;
    std::map<std::string, std::function<void(const Json&)>> assign_;
    std::map<std::string, std::function<Json()>> read_;
    mutable std::mutex mutex_;
    Json values_ = Json::object();
    Json asked_ = Json::object();  ///< where that is not the value
};

}  // namespace hive
