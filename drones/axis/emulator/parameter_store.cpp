// Defines the parameters, and the answers of param.cgi.
#include "parameter_store.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>

namespace axis::emulator {
namespace {

std::optional<int> whole_number(const std::string& text)
{
    int value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    return problem == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

std::string without_root(const std::string& name) { return name.starts_with("root.") ? name.substr(5) : name; }

bool in_group(const std::string& name, const std::string& group)
{
    return group.empty() || name == group || name.starts_with(group + ".");
}

const std::vector<std::string> resolutions{"1280x720", "640x480", "320x240", "160x120"};

}  // namespace

ParameterStore::ParameterStore(const std::string& serial)
{
    const auto fixed = [&](const char* name, const std::string& value) {
        parameters_.push_back({name, value, 0, 0, {}, true});
    };
    const auto number = [&](const char* name, int value, int least, int most) {
        parameters_.push_back({name, std::to_string(value), least, most, {}, false});
    };
    const auto choice = [&](const char* name, const char* value, std::vector<std::string> choices) {
        parameters_.push_back({name, value, 0, 0, std::move(choices), false});
    };
    fixed("Brand.Brand", "AXIS");
    fixed("Brand.ProdFullName", "AXIS Emulated Network Camera");
    fixed("Brand.ProdNbr", "Emulated");
    number("Image.I0.Appearance.Compression", 30, 0, 100);
    choice("Image.I0.Appearance.Resolution", "640x480", resolutions);
    choice("Image.I0.Appearance.Rotation", "0", {"0", "180"});
    fixed("Image.I0.Name", "Fu\xDFg\xE4nger");  // Latin-1, as cameras send it
    number("Image.I0.Stream.FPS", 0, 0, 60);
    choice("ImageSource.I0.Sensor.Exposure", "auto", {"auto", "hold", "flickerfree50", "flickerfree60"});
    number("ImageSource.I0.Sensor.Brightness", 50, 0, 100);
    number("ImageSource.I0.Sensor.ColorLevel", 50, 0, 100);
    fixed("Properties.API.HTTP.Version", "3");
    fixed("Properties.Firmware.Version", "0.1");
    fixed("Properties.Image.Format", "jpeg,mjpeg");
    fixed("Properties.Image.Resolution", "1280x720,640x480,320x240,160x120");
    fixed("Properties.System.SerialNumber", serial);
}

const ParameterStore::Parameter* ParameterStore::find(const std::string& name) const
{
    const auto found = std::ranges::find(parameters_, name, &Parameter::name);
    return found == parameters_.end() ? nullptr : &*found;
}

const std::string& ParameterStore::value(const std::string& name) const { return find(name)->value; }
int ParameterStore::number(const std::string& name) const { return whole_number(value(name)).value_or(0); }
bool ParameterStore::has_resolution(const std::string& resolution) const
{
    return std::ranges::find(resolutions, resolution) != resolutions.end();
}

std::string ParameterStore::list(const std::string& groups) const
{
    std::istringstream all(groups.empty() ? "root" : groups);
    std::string body;
    for (std::string group; std::getline(all, group, ',');) {
        const std::string wanted = group == "root" ? "" : without_root(group);
        const std::size_t before = body.size();
        for (const auto& parameter : parameters_)
            if (in_group(parameter.name, wanted))
                body += "root." + parameter.name + "=" + parameter.value + "\r\n";
        if (body.size() == before)
            body += "# Error: Error -1 getting param in group '" + group + "'\r\n";
    }
    return body;
}

bool ParameterStore::accepts(const Parameter& parameter, const std::string& value)
{
    if (parameter.fixed)
        return false;
    if (!parameter.choices.empty())
        return std::ranges::find(parameter.choices, value) != parameter.choices.end();
    const auto number = whole_number(value);
    return number && *number >= parameter.least && *number <= parameter.most;
}

std::string ParameterStore::update(const std::vector<std::pair<std::string, std::string>>& values, int step)
{
    std::string errors;
    for (const auto& [given, value] : values) {
        const std::string name = without_root(given);
        const auto found = std::ranges::find(parameters_, name, &Parameter::name);
        if (found == parameters_.end() || !accepts(*found, value)) {
            errors += "# Error: Error setting 'root." + name + "' to '" + value + "'!\r\n";
            continue;
        }
        const bool rounded = step > 1 && name.starts_with("ImageSource.") && found->choices.empty();
        found->value = rounded ? std::to_string(*whole_number(value) / step * step) : value;
    }
    return errors.empty() ? "OK\r\n" : errors;
}

}  // namespace axis::emulator
