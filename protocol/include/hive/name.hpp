// What a drone, port, parameter or group may be called: one grammar, checked in one function at every door.
#pragma once

#include <hive/error.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace hive {

/// True for `[A-Za-z0-9][A-Za-z0-9_.-]{0,63}` without `..`.
bool is_name(std::string_view text) noexcept;

/// The text itself when it is a name; otherwise throws Errc::invalid_argument, saying what a name is.
/// @param what  the thing being named, for the error: "drone", "parameter"
std::string require_name(std::string_view text, std::string_view what);

/// Shell-style match with `*` and `?`; the whole text must match.
bool matches_glob(std::string_view pattern, std::string_view text) noexcept;

/// The candidate most like `text` (by edit distance), or empty when none is near.
template <class Range>
std::string nearest(std::string_view text, const Range& candidates);

/// Errc::not_found saying `text`; its advice is the candidate that `name` may have been meant for, if one is near.
/// @param otherwise  the advice when none is
Error no_such(const std::string& text, std::string_view name, const std::vector<std::string>& candidates,
              const std::string& otherwise = {});

/// Number of single-character edits (two neighbours changing places is one) that turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b);

template <class Range>
std::string nearest(std::string_view text, const Range& candidates)
{
    std::string best;
    std::size_t best_distance = text.size() / 2 + 1;
    for (const auto& candidate : candidates)
        if (const auto distance = edit_distance(text, candidate); distance < best_distance) {
            best = candidate;
            best_distance = distance;
        }
    return best;
}

}  // namespace hive
