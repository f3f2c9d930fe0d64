// Words and variables for exec.
#include "environment.hpp"

#include <algorithm>
#include <unistd.h>

namespace hive {

std::vector<std::string> environment_with(const std::vector<std::string>& replacements)
{
    const auto same_variable = [](const std::string& a, const std::string& b) {
        return a.substr(0, a.find('=')) == b.substr(0, b.find('='));
    };
    std::vector<std::string> result = replacements;
    for (char** variable = environ; *variable; ++variable)
        if (std::ranges::none_of(replacements,
                                 [&](const auto& replacement) { return same_variable(replacement, *variable); }))
            result.emplace_back(*variable);
    return result;
}

std::vector<char*> pointers(const std::vector<std::string>& texts)
{
    std::vector<char*> result;
    for (const auto& text : texts)
        result.push_back(const_cast<char*>(text.c_str()));  // the interface of exec is older than const
    result.push_back(nullptr);
    return result;
}

}  // namespace hive
