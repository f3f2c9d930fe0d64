// The grammar of names, globs over them, and suggestions for misspelt ones.
#include <hive/json.hpp>
#include <hive/name.hpp>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace hive {
namespace {

bool is_alphanumeric(char c) noexcept
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

}  // namespace

bool is_name(std::string_view text) noexcept
{
    return !text.empty() && text.size() <= 64 && is_alphanumeric(text.front())
           && text.find("..") == std::string_view::npos
           && std::ranges::all_of(text, [](char c) { return is_alphanumeric(c) || c == '_' || c == '.' || c == '-'; });
}

std::string require_name(std::string_view text, std::string_view what)
{
    if (!is_name(text))
        throw Error(Errc::invalid_argument,
                    in_quotes(text) + " is not a " + std::string(what)
                        + " name: 1 to 64 letters, digits, '_', '.' or '-', starting with a letter or digit");
    return std::string(text);
}

std::string require_port_name(std::string_view text, std::string_view what)
{
    if (text.find('.') != std::string_view::npos)
        throw Error(Errc::invalid_argument,
                    in_quotes(text) + " is not the name of an " + std::string(what) + ", because it has a point",
                    "write _ or - instead");
    return require_name(text, what);
}

bool belongs_to(std::string_view text, std::string_view drone) noexcept
{
    return text == drone
           || (text.size() > drone.size() + 1 && text.starts_with(drone) && text.rfind('.') == drone.size());
}

Error no_such(const std::string& text, std::string_view name, const std::vector<std::string>& candidates,
              const std::string& otherwise)
{
    const auto near = nearest(name, candidates);
    return {Errc::not_found, text, near.empty() ? otherwise : "did you mean " + near + "?"};
}

bool matches_glob(std::string_view pattern, std::string_view text) noexcept
{
    std::size_t p = 0, t = 0, star = std::string_view::npos, resume = 0;
    while (t < text.size()) {
        if (p < pattern.size() && (pattern[p] == '?' || (pattern[p] == text[t] && pattern[p] != '*'))) {
            ++p;
            ++t;
        } else if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            resume = t;
        } else if (star != std::string_view::npos) {
            p = star + 1;
            t = ++resume;
        } else {
            return false;
        }
    }
    return std::ranges::all_of(pattern.substr(p), [](char c) { return c == '*'; });
}

std::size_t edit_distance(std::string_view a, std::string_view b)
{
    // Row by row; only the two previous rows are needed.
    std::vector<std::size_t> before, above(b.size() + 1), row(b.size() + 1);
    std::iota(above.begin(), above.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        before = std::exchange(above, row);
    }
    return above.back();
}

}  // namespace hive
