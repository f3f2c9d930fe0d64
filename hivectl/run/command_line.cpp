// Implements command_line.hpp with CLI11.
#include "run/command_line.hpp"

#include "words/format.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>

#include <hive/json.hpp>
#include <hive/printable.hpp>
#include <hive/transfer.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>

namespace hivectl {

Option Option::required() const { return Option(option_->required()); }
Option Option::type_name(const std::string& name) const { return Option(option_->type_name(name)); }
Option Option::excludes(Option other) const { return Option(option_->excludes(other.option_)); }
Option Option::needs(Option other) const { return Option(option_->needs(other.option_)); }
Option Option::one_each() const { return Option(option_->allow_extra_args(false)); }
Option Option::one_of(const std::vector<std::string>& words) const
{
    std::string list, values;
    for (const auto& word : words) {
        values += (values.empty() ? "" : "|") + word;
        list += (list.empty() ? "" : word == words.back() ? " or " : ", ") + word;
    }
    const auto problem = [=](const std::string& text) {
        return std::ranges::find(words, text) != words.end() ? std::string()
                                                             : hive::in_quotes(text) + " is not " + list;
    };
    return Option(option_->check(problem, values, "one of"));
}

template <typename Number>
Option Option::between(Number least, Number most) const
{
    const auto problem = [=](const std::string& text) {
        Number value{};
        const bool number = CLI::detail::lexical_cast(text, value);
        return number && value >= least && value <= most
                   ? std::string()
                   : hive::in_quotes(text) + " is not a number from " + hive::to_text(hive::Json(least)) + " to "
                         + hive::to_text(hive::Json(most));
    };
    return Option(option_->check(problem, "", "range"));
}
template Option Option::between(int, int) const;
template Option Option::between(std::int64_t, std::int64_t) const;
template Option Option::between(double, double) const;

/// Numbers without a unit stay as written, since some are forwarded.
Option Option::measured(const Reader& reader, double least, double most, const std::string& examples) const
{
    const auto read = [=](std::string& text) -> std::string {
        const auto value = reader(text);
        if (!value)
            return hive::in_quotes(text) + " is not written as " + examples;
        if (*value < least || *value > most)
            return hive::in_quotes(text) + (*value < least ? " is too small" : " is too large");
        if (text.find_first_not_of("0123456789.") != std::string::npos)
            text =
                *value == std::floor(*value) ? std::to_string(std::llround(*value)) : hive::to_text(hive::Json(*value));
        return {};
    };
    return Option(option_->transform(CLI::Validator(read, "", "measure")));
}

Option Option::seconds(double least, double most) const
{
    return measured([](const std::string& text) { return seconds_of(text); }, least, most, "2, 500ms or 2min");
}

Option Option::milliseconds(int least, int most) const
{
    const auto reader = [](const std::string& text) {
        const auto seconds = seconds_of(text, "ms");
        return seconds ? std::optional(std::round(*seconds * 1000)) : std::nullopt;
    };
    return measured(reader, least, most, "20, 20ms or 2s");
}

Option Option::megabytes(double least, double most) const
{
    const auto reader = [](const std::string& text) {
        const auto bytes = bytes_of(text, "MB");
        return bytes ? std::optional(*bytes / 1e6) : std::nullopt;
    };
    return measured(reader, least, most, "200, 200MB or 2GB");
}

Option Option::count(std::int64_t most) const { return type_name("N").between(std::int64_t{1}, most); }

Option Option::encoding() const
{
    const auto problem = [](const std::string& text) {
        return hive::is_encoding(text)
                   ? std::string()
                   : text + " is not written as an encoding; write for example raw, png, jpeg or jpeg:80";
    };
    return Option(option_->check(problem, "raw|png|jpeg", "encoding"));
}

namespace {

/// Rewords errors such as "--as: 1 required NAME missing".
std::string reworded(const CLI::ParseError& error)
{
    const std::string text = error.what();
    const std::string name = text.substr(0, text.find_first_of(": "));
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error))
        return name + " needs a value";
    const std::string other = text.substr(text.rfind(' ') + 1);
    if (dynamic_cast<const CLI::ExcludesError*>(&error))
        return name + " cannot be combined with " + other;
    if (dynamic_cast<const CLI::RequiresError*>(&error))
        return name + " is only used with " + other;
    return text;
}

}  // namespace

CommandLine::CommandLine() : app_(std::make_unique<CLI::App>()) { app_->set_help_flag("-h,--help", "print this"); }
CommandLine::~CommandLine() = default;

template <typename Value>
Option CommandLine::option(const std::string& names, Value& value, const std::string& meaning)
{
    return Option(app_->add_option(names, value, meaning));
}
template Option CommandLine::option(const std::string&, std::string&, const std::string&);
template Option CommandLine::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option CommandLine::option(const std::string&, int&, const std::string&);
template Option CommandLine::option(const std::string&, std::int64_t&, const std::string&);
template Option CommandLine::option(const std::string&, double&, const std::string&);
template Option CommandLine::option(const std::string&, std::optional<int>&, const std::string&);
template Option CommandLine::option(const std::string&, std::optional<double>&, const std::string&);

Option CommandLine::flag(const std::string& names, bool& value, const std::string& meaning)
{
    return Option(app_->add_flag(names, value, meaning));
}

bool CommandLine::read(int argc, char** argv)
{
    try {
        app_->parse(argc, argv);
        return true;
    } catch (const CLI::CallForHelp&) {
        return false;
    } catch (const CLI::ExtrasError&) {
        const auto wrong = app_->remaining().front();
        throw UsageError((wrong.starts_with('-') ? "no option " : "unexpected argument ") + hive::in_quotes(wrong));
    } catch (const CLI::ParseError& error) {
        throw UsageError(reworded(error));
    }
}

namespace {

/// @param words  "a|b|c"
std::vector<std::string> split(const std::string& words)
{
    std::vector<std::string> parts;
    std::istringstream in(words);
    for (std::string part; std::getline(in, part, '|');)
        parts.push_back(part);
    return parts;
}

CommandLine::Entry entry_of(const CLI::Option& option)
{
    // "FORM:a|b": the validators' descriptions follow the type.
    const std::string type = option.get_expected_max() > 0 ? option.get_type_name() : "";
    const auto colon = type.find(':');
    return {.positional = option.get_positional(),
            .name = option.get_name(true, false),
            .short_names = option.get_snames(),
            .long_names = option.get_lnames(),
            .type = type.substr(0, colon),
            .meaning = option.get_description(),
            .values = colon == std::string::npos ? std::vector<std::string>() : split(type.substr(colon + 1))};
}

}  // namespace

std::vector<CommandLine::Entry> CommandLine::entries() const
{
    std::vector<Entry> all;
    for (const CLI::Option* option : static_cast<const CLI::App&>(*app_).get_options())
        all.push_back(entry_of(*option));
    return all;
}

std::optional<CommandLine::Entry> CommandLine::option_with_value(const std::string& word) const
{
    const CLI::Option* option = word.starts_with('-') ? app_->get_option_no_throw(word) : nullptr;
    return option && option->get_items_expected_max() > 0 ? std::optional(entry_of(*option)) : std::nullopt;
}

}  // namespace hivectl
