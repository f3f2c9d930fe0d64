// The options and arguments of a verb. CLI11 parses them; it takes seconds to compile, so only command_line.cpp
// includes it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace hivectl {

/// An invalid command line; what() has the reason.
class UsageError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// One declared option or argument, to refine it; copies are the same option.
class Option {
public:
    explicit Option(CLI::Option* option) : option_(option) {}

    Option required() const;
    Option type_name(const std::string& name) const;  ///< how --help writes the value
    Option excludes(Option other) const;
    Option needs(Option other) const;
    Option one_each() const;  ///< for several values: the option is repeated before each

    // Valid values; completion offers the keywords:
    Option one_of(const std::vector<std::string>& words) const;
    template <typename Number>
    Option between(Number least, Number most) const;  ///< of int, std::int64_t or double
    /// A number of events, at least 1.
    Option count(std::int64_t most = std::int64_t{1} << 53) const;
    /// A duration, "2", "500ms" or "2min", within the limits of a deadline; the value is in seconds.
    Option seconds(double least = 0.001, double most = 1e8) const;
    /// A duration of whole milliseconds; a number alone is in milliseconds.
    Option milliseconds(int least, int most) const;
    /// A size, "200", "200MB" or "2GB"; the value is in megabytes.
    Option megabytes(double least, double most) const;
    /// An image encoding, by `hive::is_encoding`.
    Option encoding() const;

private:
    using Reader = std::function<std::optional<double>(const std::string&)>;

    [[nodiscard]] Option measured(const Reader& reader, double least, double most, const std::string& examples) const;

    CLI::Option* option_;
};

/// The command line of one verb: declared first, then parsed, or shown by --help and completion.
class CommandLine {
public:
    CommandLine();
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    /// An option if `names` starts with a hyphen ("-o,--output"), otherwise the next positional argument.
    /// @param value  of std::string, a number, an optional of one, or std::vector<std::string>; set by read(), so it
    ///               must live until then
    template <typename Value>
    Option option(const std::string& names, Value& value, const std::string& meaning);
    Option flag(const std::string& names, bool& value, const std::string& meaning);

    /// Sets the values; false: help was requested. Throws UsageError.
    [[nodiscard]] bool read(int argc, char** argv);

    /// The declared options and arguments, in order, for --help and completion.
    struct Entry {
        bool positional = false;
        std::string name;                                  ///< of an argument, with "..." if there may be several
        std::vector<std::string> short_names, long_names;  ///< of an option, without hyphens
        std::string type;                                  ///< of an option's value; empty: no value
        std::string meaning;
        std::vector<std::string> values;  ///< all valid ones, or the usual ones; empty: unknown
    };
    [[nodiscard]] std::vector<Entry> entries() const;
    /// The option whose value is the next argument; nothing if `word` is not an option with a value.
    [[nodiscard]] std::optional<Entry> option_with_value(const std::string& word) const;

private:
    std::unique_ptr<CLI::App> app_;
};

}  // namespace hivectl
