// The emulated camera's parameters, listed and updated as param.cgi does.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace axis::emulator {

class ParameterStore {
public:
    explicit ParameterStore(const std::string& serial);

    /// The body that answers a list. @param groups  joined by commas, with or without "root."; empty: all
    [[nodiscard]] std::string list(const std::string& groups) const;
    /// The body that answers an update. Like a camera it sets the valid values, even if it refuses another.
    /// @param step  sensor values are rounded down to multiples of it
    std::string update(const std::vector<std::pair<std::string, std::string>>& values, int step);

    /// The value of a parameter that there is.
    [[nodiscard]] const std::string& value(const std::string& name) const;
    [[nodiscard]] int number(const std::string& name) const;
    [[nodiscard]] bool has_resolution(const std::string& resolution) const;

private:
    struct Parameter {
        std::string name, value;
        int least = 0, most = 0;           ///< a number, if they differ
        std::vector<std::string> choices;  ///< a word, if there are any
        bool fixed = false;
    };

    [[nodiscard]] const Parameter* find(const std::string& name) const;
    [[nodiscard]] static bool accepts(const Parameter& parameter, const std::string& value);

    std::vector<Parameter> parameters_;
};

}  // namespace axis::emulator
