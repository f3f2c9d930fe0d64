// Writes families in the two text formats, which differ in suffixes, units, start times and the end, and as JSON.
#include <hive/metrics.hpp>

#include <array>
#include <charconv>
#include <cmath>

namespace hive {
namespace {

using Type = MetricFamily::Type;

/// @param quotes  whether a quotation mark is escaped as well
std::string escaped(std::string_view text, bool quotes)
{
    std::string result;
    for (const char c : text)
        if (c == '\\')
            result += "\\\\";
        else if (c == '\n')
            result += "\\n";
        else if (c == '"' && quotes)
            result += "\\\"";
        else
            result += c;
    return result;
}

/// Shortest text that reads back as the same number; whole numbers without a point.
std::string number(double value)
{
    constexpr double exact = 9007199254740992;  // 2^53
    if (std::abs(value) < exact && value == std::trunc(value))
        return std::to_string(static_cast<std::int64_t>(value));
    std::array<char, 32> text{};
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// Whole microseconds as seconds.
std::string seconds(std::int64_t us)
{
    const auto fraction = std::to_string(1'000'000 + us % 1'000'000);
    return std::to_string(us / 1'000'000) + "." + fraction.substr(1);
}

std::string labels_text(const MetricSample& sample)
{
    std::string text;
    for (const auto& [name, value] : sample.labels)
        text += (text.empty() ? "{" : ",") + name + "=\"" + escaped(value, true) + "\"";
    return text.empty() ? text : text + "}";
}

const char* suffix(Type type) { return type == Type::counter ? "_total" : type == Type::info ? "_info" : ""; }

const char* type_name(Type type, bool open)
{
    switch (type) {
    case Type::counter: return "counter";
    case Type::gauge: break;
    case Type::info: return open ? "info" : "gauge";
    case Type::state: return open ? "stateset" : "gauge";
    }
    return "gauge";
}

void append(std::string& text, const MetricFamily& family, bool open)
{
    const auto sample_name = family.name + suffix(family.type);
    const auto& name = open ? family.name : sample_name;
    text += "# TYPE " + name + " " + type_name(family.type, open) + "\n";
    if (open && !family.unit.empty())
        text += "# UNIT " + name + " " + family.unit + "\n";
    text += "# HELP " + name + " " + escaped(family.help, open) + "\n";
    for (const auto& sample : family.samples) {
        const auto labels = labels_text(sample);
        text += sample_name + labels + " " + number(sample.value) + "\n";
        if (open && family.type == Type::counter && sample.created_us > 0)
            text += family.name + "_created" + labels + " " + seconds(sample.created_us) + "\n";
    }
}

}  // namespace

std::string to_text(const Metrics& metrics, MetricsForm form)
{
    const bool open = form == MetricsForm::openmetrics;
    std::string text;
    for (const auto& family : metrics)
        append(text, family, open);
    return open ? text + "# EOF\n" : text;
}

Json to_json(const Metrics& metrics)
{
    Json families = Json::array();
    for (const auto& family : metrics) {
        Json samples = Json::array();
        for (const auto& sample : family.samples) {
            Json labels = Json::object();
            for (const auto& [name, value] : sample.labels)
                labels[name] = value;
            samples.push_back({{"labels", std::move(labels)}, {"value", sample.value}});
            if (sample.created_us > 0)
                samples.back()["created_us"] = sample.created_us;
        }
        families.push_back({{"name", family.name}, {"type", type_name(family.type, true)}, {"help", family.help}});
        if (!family.unit.empty())
            families.back()["unit"] = family.unit;
        families.back()["samples"] = std::move(samples);
    }
    return families;
}

std::string_view media_type(MetricsForm form) noexcept
{
    return form == MetricsForm::openmetrics ? "application/openmetrics-text; version=1.0.0; charset=utf-8"
                                            : "text/plain; version=0.0.4; charset=utf-8";
}

MetricsForm metrics_form(std::string_view accept)
{
    return accept.find("application/openmetrics-text") == std::string_view::npos ? MetricsForm::prometheus
                                                                                 : MetricsForm::openmetrics;
}

}  // namespace hive
