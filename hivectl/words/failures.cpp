#include "words/failures.hpp"

#include "words/exit_code.hpp"
#include "words/output.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <string>

namespace hivectl {
namespace {

constexpr std::size_t max_shown = 20;

bool in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-'; }

/// The first line, without the drone's name and without numbers.
std::string kind_of(const hive::SwarmFailure& failure)
{
    const std::string_view text = failure.error.what();
    const auto line = text.substr(0, text.find('\n'));
    std::string kind;
    for (std::size_t at = 0; at < line.size();) {
        const auto end = std::ranges::find_if_not(line.substr(at), in_word) - line.substr(at).begin();
        const auto word = line.substr(at, std::max<std::size_t>(1, static_cast<std::size_t>(end)));
        if (word != failure.drone)
            kind += word;
        at += word.size();
    }
    std::erase_if(kind, [](char c) { return c >= '0' && c <= '9'; });
    return kind;
}

}  // namespace

std::vector<std::vector<hive::SwarmFailure>> alike(const std::vector<hive::SwarmFailure>& failures)
{
    std::map<std::string, std::size_t> places;
    std::vector<std::vector<hive::SwarmFailure>> groups;
    for (const auto& failure : failures) {
        const auto place = places.try_emplace(kind_of(failure), groups.size()).first->second;
        if (place == groups.size())
            groups.emplace_back();
        groups[place].push_back(failure);
    }
    return groups;
}

void complain_about(std::string_view verb, const std::vector<hive::SwarmFailure>& failures)
{
    for (const auto& group : alike(failures)) {
        const auto shown = prints_failures_as_json() ? group.size() : std::min(group.size(), max_shown);
        for (std::size_t i = 0; i < shown; ++i)
            complain_about(verb, group[i].error, group[i].drone);
        if (shown < group.size())
            complain(verb, "and " + std::to_string(group.size() - shown) + " more of the same kind; see all: --json");
    }
}

}  // namespace hivectl
