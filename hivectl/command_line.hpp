// The options and arguments of a verb. CLI11 reads them; it takes seconds to compile, so command_line.cpp alone knows
// it.
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

/// A command line that cannot be read; what() says why.
class UsageError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// One declared option or argument, to say more about it; copies are the same option.
class Option {
public:
    explicit Option(CLI::Option* option) : option_(option) {}

    Option required() const;
    Option type_name(const std::string& name) const;  ///< how --help writes the value
    Option excludes(Option other) const;
    Option needs(Option other) const;
    Option one_each() const;  ///< of several values: each has the option before it

    // What a value may be; completion offers the words:
    Option one_of(const std::vector<std::string>& words) const;
    template <typename Number>
    Option between(Number least, Number most) const;  ///< of int, std::int64_t or double
    /// A duration, "2", "500ms" or "2min", within what a deadline can be; the value is in seconds.
    Option seconds(double least = 0.001, double most = 1e8) const;
    /// A duration of whole milliseconds; a number alone is in milliseconds.
    Option milliseconds(int least, int most) const;
    /// A size, "200", "200MB" or "2GB"; the value is in megabytes.
    Option megabytes(double least, double most) const;
    /// How pictures travel, as `hive::is_encoding` knows it.
    Option encoding() const;

private:
    using Reader = std::function<std::optional<double>(const std::string&)>;

    [[nodiscard]] Option measured(const Reader& reader, double least, double most, const std::string& examples) const;

    CLI::Option* option_;
};

/// What one verb takes: declared first, then read, or shown by --help and completion.
class CommandLine {
public:
    CommandLine();
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    /// An option when `names` begins with a hyphen ("-o,--output"), or else the argument that stands at the next place.
    /// @param value  of std::string, a number, an optional of one, or std::vector<std::string>; set by read(), until
    /// when it has to live
    template <typename Value>
    Option option(const std::string& names, Value& value, const std::string& meaning);
    Option flag(const std::string& names, bool& value, const std::string& meaning);

    /// Sets the values; false: help was asked for. Throws UsageError.
    [[nodiscard]] bool read(int argc, char** argv);

    /// What is declared, in that order, for --help and completion.
    struct Entry {
        bool positional = false;
        std::string name;                                  ///< of an argument, with "..." if there may be several
        std::vector<std::string> short_names, long_names;  ///< of an option, without hyphens
        std::string type;                                  ///< of an option's value; empty: it takes none
        std::string meaning;
        std::vector<std::string> values;  ///< all that it may be, or the usual ones; empty: not known
    };
    [[nodiscard]] std::vector<Entry> entries() const;
    /// The option whose value is the next word; nothing if `word` is none.
    [[nodiscard]] std::optional<Entry> option_with_value(const std::string& word) const;

private:
    std::unique_ptr<CLI::App> app_;
};

}  // namespace hivectl
