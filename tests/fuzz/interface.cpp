// An interface survives the way; a parameter takes only values that it allows, and takes its own values again.
// Input: JSON {"interface": …, "values": [ … ]}.
#include "require.hpp"

#include <hive/error.hpp>
#include <hive/interface.hpp>
#include <hive/name.hpp>
#include <hive/transfer.hpp>

#include <cmath>

namespace {

using hive::Json;
using hive::fuzz::require;

bool allowed(const hive::ParameterInfo& parameter, const Json& value)
{
    using Type = hive::ParameterType;
    switch (parameter.type) {
    case Type::flag: return value.is_boolean();
    case Type::text: return value.is_string() && value.get<std::string>().find('\0') == std::string::npos;
    case Type::integer:
        if (!value.is_number_integer() || std::abs(value.get<std::int64_t>()) > hive::max_json_integer)
            return false;
        break;
    case Type::number:
        if (!value.is_number_float() || !std::isfinite(value.get<double>()))
            return false;
        break;
    }
    const auto number = value.get<double>();
    return !(parameter.least && number < *parameter.least) && !(parameter.most && number > *parameter.most);
}

void try_value(const hive::ParameterInfo& parameter, const Json& value)
{
    try {
        const Json taken = hive::checked_value(parameter, value);
        require(allowed(parameter, taken), "a parameter takes only what it allows");
        require(hive::checked_value(parameter, taken) == taken, "a parameter takes its own value");
    } catch (const hive::Error& error) {
        require(error.code() == hive::Errc::refused, "a value is refused as refused");
        require(!hive::to_text(Json(error.what())).empty(), "a refusal can be printed");
    }
}

void check_ports(const hive::Interface& interface)
{
    for (const auto& output : interface.outputs) {
        require(hive::is_name(output.name), "a port has a name");
        for (const auto& input : interface.inputs)
            require(hive::types_fit(output.type, input.type) == hive::types_fit(input.type, output.type),
                    "fitting is symmetric");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    try {
        const Json input = hive::parse_json(std::string_view(reinterpret_cast<const char*>(bytes), size));
        const hive::Fields fields(input, "input");
        const auto interface = hive::interface_from_json(fields.object("interface"));
        const Json written = to_json(interface);
        require(to_json(hive::interface_from_json(hive::parse_json(hive::to_text(written), {.bytes = 1 << 20})))
                    == written,
                "an interface survives the way");
        check_ports(interface);
        for (const auto& parameter : interface.parameters)
            for (const auto& value : fields.array("values"))
                try_value(parameter, value);
    } catch (const hive::Error&) {  // a refusal is an answer
    }
    return 0;
}
