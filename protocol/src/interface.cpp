// The interface description as JSON and back.
#include <hive/error.hpp>
#include <hive/interface.hpp>
#include <hive/name.hpp>

#include <algorithm>
#include <cmath>

namespace hive {
namespace {

template <class Item>
const Item* find(const std::vector<Item>& items, std::string_view name)
{
    const auto found = std::ranges::find(items, name, &Item::name);
    return found == items.end() ? nullptr : &*found;
}

Json to_json(const Encoding& encoding)
{
    Json object{{"word", encoding.word}, {"type", encoding.type}};
    if (encoding.least <= encoding.most)
        object.update({{"min", encoding.least}, {"max", encoding.most}});
    return object;
}

Json to_json(const std::vector<Port>& ports)
{
    Json array = Json::array();
    for (const auto& port : ports) {
        array.push_back({{"name", port.name}, {"type", port.type}, {"help", port.help}});
        for (const auto& encoding : port.encodings)
            array.back()["encodings"].push_back(to_json(encoding));
    }
    return array;
}

/// An integer's bound is written as an integer, within the range of JSON integers.
void write_bound(Json& object, const char* key, const ParameterInfo& parameter, std::optional<double> bound)
{
    if (!bound || !std::isfinite(*bound))
        return;
    constexpr auto most = static_cast<double>(max_json_integer);
    if (parameter.type == ParameterType::integer && std::trunc(*bound) == *bound && std::abs(*bound) <= most)
        object[key] = static_cast<std::int64_t>(*bound);
    else
        object[key] = *bound;
}

Json to_json(const ParameterInfo& parameter)
{
    Json object{
        {"name", parameter.name}, {"type", token(parameter.type)}, {"unit", parameter.unit}, {"help", parameter.help}};
    if (!parameter.default_value.is_null())
        object["default"] = parameter.default_value;
    write_bound(object, "min", parameter, parameter.least);
    write_bound(object, "max", parameter, parameter.most);
    if (!parameter.choices.empty())
        object["choices"] = parameter.choices;
    if (parameter.for_operator)
        object["operator"] = true;
    return object;
}

template <class Item>
void require_new(const std::vector<Item>& items, const Item& item)
{
    if (find(items, item.name))
        throw Error(Errc::malformed, "interface: two are called " + in_quotes(item.name));
}

Encoding encoding(const Json& object)
{
    const Fields fields(object, "encoding");
    Encoding result{.word = fields.text("word"), .type = fields.text("type")};
    if (!is_encoding(result.word) || result.word.find(':') != std::string::npos)
        throw Error(Errc::malformed, "encoding: " + in_quotes(result.word) + " is no word");
    if (fields.has("min") || fields.has("max")) {
        result.least = fields.integer("min", 0, max_json_integer);
        result.most = fields.integer("max", result.least, max_json_integer);
    }
    return result;
}

std::vector<Port> ports(const Json& array)
{
    std::vector<Port> result;
    for (const auto& item : array) {
        const Fields fields(item, "port");
        Port port{fields.name("name"), fields.text("type"), fields.text_or("help", "")};
        require_new(result, port);
        if (fields.has("encodings"))
            for (const auto& one : fields.array("encodings"))
                port.encodings.push_back(encoding(one));
        result.push_back(std::move(port));
    }
    return result;
}

ParameterType parameter_type(const std::string& text)
{
    for (const auto type : {ParameterType::integer, ParameterType::number, ParameterType::text, ParameterType::flag})
        if (token(type) == text)
            return type;
    throw Error(Errc::malformed, "parameter: unknown type " + in_quotes(text));
}

std::optional<double> bound(const Json& object, const char* key)
{
    const auto found = object.find(key);
    if (found == object.end())
        return std::nullopt;
    if (!found->is_number())
        throw Error(Errc::malformed, "parameter: \"" + std::string(key) + "\" must be a number");
    return found->get<double>();
}

ParameterInfo parameter(const Json& object)
{
    const Fields fields(object, "parameter");
    ParameterInfo result{.name = fields.name("name"),
                         .type = parameter_type(fields.text("type")),
                         .default_value = object.value("default", Json()),
                         .least = bound(object, "min"),
                         .most = bound(object, "max"),
                         .choices = {},
                         .unit = fields.text_or("unit", ""),
                         .help = fields.text_or("help", ""),
                         .for_operator = fields.flag_or("operator", false)};
    if (fields.has("choices"))
        for (const auto& choice : fields.array("choices")) {
            if (!choice.is_string())
                throw Error(Errc::malformed, "parameter: every choice must be a string");
            result.choices.push_back(choice.get<std::string>());
        }
    return result;
}

}  // namespace

const Port* Interface::input(std::string_view name) const { return find(inputs, name); }
const Port* Interface::output(std::string_view name) const { return find(outputs, name); }
const ParameterInfo* Interface::parameter(std::string_view name) const { return find(parameters, name); }

Json to_json(const Interface& interface)
{
    Json parameters = Json::array();
    for (const auto& item : interface.parameters)
        parameters.push_back(to_json(item));
    return {{"kind", interface.kind},
            {"summary", interface.summary},
            {"version", interface.version},
            {"stateful", interface.stateful},
            {"inputs", to_json(interface.inputs)},
            {"outputs", to_json(interface.outputs)},
            {"parameters", parameters}};
}

Interface interface_from_json(const Json& object)
{
    const Fields fields(object, "interface");
    Interface result{.kind = fields.name("kind"),
                     .summary = fields.text_or("summary", ""),
                     .version = fields.text_or("version", ""),
                     .stateful = fields.flag_or("stateful", false),
                     .inputs = ports(fields.array("inputs")),
                     .outputs = ports(fields.array("outputs")),
                     .parameters = {}};
    for (const auto& item : fields.array("parameters")) {
        auto read = parameter(item);
        require_new(result.parameters, read);
        result.parameters.push_back(std::move(read));
    }
    return result;
}

}  // namespace hive
