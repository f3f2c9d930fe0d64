// The functions of parameters.
#include "declared.hpp"
#include "drone_object.hpp"
#include "texts.hpp"

#include <hive/name.hpp>

using namespace hive;
using namespace hive::c;

namespace {

constexpr std::initializer_list<const char*> constraint_fields{"least", "most", "choices", "unit", "operator"};

Constraint constraint_of(const Options& options)
{
    return {options.number("least"), options.number("most"), options.texts("choices"), options.text("unit"),
            options.flag("operator")};
}

/// Declares it on the caller's variable, and keeps the address.
template <class Value>
void bind_to(hive_drone* drone, const char* name, Value* variable, const char* constraint, const char* help,
             Value* Variable::*place)
{
    const auto object = get<DroneObject>(drone);
    Variable kept{.name = text_of(name, "the name")};
    kept.*place = required(variable, "the variable");
    const auto open = object->declaring();
    require_parameter(open->interface(), kept.name);
    open->drone().parameter(kept.name, *variable, constraint_of({constraint, constraint_fields}), text_or_empty(help));
    object->add(std::move(kept));
}

/// The default value, in a variable of the type that the declaration names.
Variable own_variable(DroneObject& drone, const std::string& type, const Json& value)
{
    if (type == "integer" && value.is_number_integer())
        return {.integer = &drone.integers.emplace_back(static_cast<int>(json_integer(value).value_or(0)))};
    if (type == "number" && value.is_number())
        return {.number = &drone.numbers.emplace_back(value.get<double>())};
    if (type == "flag" && value.is_boolean())
        return {.flag = &drone.flags.emplace_back(value.get<bool>())};
    if (type == "text" && value.is_string())
        return {.text = &drone.texts.emplace_back(value.get<std::string>())};
    throw Error(Errc::invalid_argument, to_text(value) + " is not a default of type " + in_quotes(type)
                                            + "; types are integer, number, flag and text");
}

void declare(EmbeddedDrone& drone, const Variable& variable, const Constraint& constraint, const std::string& help)
{
    if (variable.integer)
        drone.drone().parameter(variable.name, *variable.integer, constraint, help);
    else if (variable.number)
        drone.drone().parameter(variable.name, *variable.number, constraint, help);
    else if (variable.flag)
        drone.drone().parameter(variable.name, *variable.flag, constraint, help);
    else
        drone.drone().parameter(variable.name, *variable.text, constraint, help);
}

/// A default must fit into an int.
void require_int(const Json& value)
{
    const auto number = json_integer(value);
    if (value.is_number_integer() && (!number || *number < INT32_MIN || *number > INT32_MAX))
        throw Error(Errc::invalid_argument, to_text(value) + " is more than an integer parameter holds");
}

}  // namespace

hive_code hive_drone_parameter(hive_drone* drone, const char* json)
{
    return guarded([&] {
        const auto object = get<DroneObject>(drone);
        const auto open = object->declaring();
        required(json, "the declaration");
        const Options options(json,
                              {"name", "type", "default", "help", "least", "most", "choices", "unit", "operator"});
        const Json value = json_of(json, "the declaration").value("default", Json());
        require_int(value);
        const std::string name = require_name(options.text("name"), "parameter");
        require_parameter(open->interface(), name);
        const Constraint constraint = constraint_of(options);
        Variable variable = own_variable(*object, options.text("type"), value);
        variable.name = name;
        declare(*open, variable, constraint, options.text("help"));
        object->add(std::move(variable));
    });
}

hive_code hive_drone_integer(hive_drone* drone, const char* name, int* variable, const char* constraint,
                             const char* help)
{
    return guarded([&] { bind_to(drone, name, variable, constraint, help, &Variable::integer); });
}

hive_code hive_drone_number(hive_drone* drone, const char* name, double* variable, const char* constraint,
                            const char* help)
{
    return guarded([&] { bind_to(drone, name, variable, constraint, help, &Variable::number); });
}

hive_code hive_drone_flag(hive_drone* drone, const char* name, bool* variable, const char* constraint, const char* help)
{
    return guarded([&] { bind_to(drone, name, variable, constraint, help, &Variable::flag); });
}

hive_code hive_drone_text(hive_drone* drone, const char* name, const char** variable, const char* constraint,
                          const char* help)
{
    return guarded([&] {
        const auto object = get<DroneObject>(drone);
        const auto open = object->declaring();
        const std::string known = text_of(name, "the name");
        auto& text = object->texts.emplace_back(text_or_empty(*required(variable, "the variable")));
        open->drone().parameter(known, text, constraint_of({constraint, constraint_fields}), text_or_empty(help));
        Variable kept{.name = known, .text = &text, .shown = variable};
        kept.show();
        object->add(std::move(kept));
    });
}

hive_code hive_drone_values(const hive_drone* drone, char** json, size_t* length)
{
    return guarded([&] {
        const auto object = get<DroneObject>(drone);
        const auto open = object->on_user_thread();
        give_json(object->values(), json, length);
    });
}

hive_code hive_drone_assign(hive_drone* drone, const char* json)
{
    return guarded([&] {
        const auto object = get<DroneObject>(drone);
        const auto open = object->on_user_thread();
        const Json values = json_of(text_of(json, "the values").c_str(), "the values");
        if (!values.is_object())
            throw Error(Errc::invalid_argument, "the values are not a JSON object");
        object->assign(values);
    });
}
