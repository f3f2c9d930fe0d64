// The parameters of one drone: bound to the author's variables, checked, and reported.
#pragma once

#include <hive/interface.hpp>

#include <functional>
#include <mutex>
#include <vector>

namespace hive {

/// Declared before the drone runs. The variables belong to the user thread; the reported values are for any thread.
class ParameterSet {
public:
    template <class Value>
    void add(ParameterInfo parameter, Value& variable)
    {
        parameter.default_value = variable;
        (void)checked_value(parameter,
                            parameter.default_value);  // a default outside its range is the author's error
        values_[parameter.name] = parameter.default_value;
        assign_[parameter.name] = [&variable](const Json& value) { variable = value.get<Value>(); };
        read_[parameter.name] = [&variable] { return Json(variable); };
        declared_.push_back(std::move(parameter));
    }

    [[nodiscard]] const std::vector<ParameterInfo>& declared() const noexcept { return declared_; }
    /// The checked values of `wanted`. Throws Errc::not_found (with the most similar name) or Errc::refused.
    [[nodiscard]] Json checked(const Json& wanted) const;
    /// The user thread. Assigns checked values to the variables; the reported values stay until read_back().
    void assign(const Json& checked_values);
    /// The user thread. Reports the variables' current values from now on.
    /// @param checked_values  the assigned values, before the drone's code changed them
    void read_back(const Json& checked_values);
    /// The user thread. Reverts the variables to the reported values.
    void put_back() { assign(values()); }
    /// The user thread. The variables' values of the parameters in `wanted`.
    [[nodiscard]] Json assigned(const Json& wanted) const;
    /// Throws Errc::too_large when the drone's code has changed its variables to values over the limits of a header,
    /// and of the state file.
    void require_tellable() const;
    /// All values, or those named. Throws Errc::not_found.
    [[nodiscard]] Json values(const std::vector<std::string>& names = {}) const;
    /// The same as requested: the drone's code may have changed a value, for example by rounding.
    [[nodiscard]] Json asked(const std::vector<std::string>& names = {}) const;
    /// The requested values that differ from the default.
    [[nodiscard]] Json changed() const;

private:
    [[nodiscard]] const ParameterInfo& find(const std::string& name) const;

    std::vector<ParameterInfo> declared_;
    std::map<std::string, std::function<void(const Json&)>> assign_;
    std::map<std::string, std::function<Json()>> read_;
    mutable std::mutex mutex_;
    Json values_ = Json::object();
    Json asked_ = Json::object();  ///< requested values that differ from the value
};

}  // namespace hive
