// The one grammar for names of drones, ports, parameters and groups.
#pragma once

#include <hive/error.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace hive {

/// True for `[A-Za-z0-9][A-Za-z0-9_.-]{0,63}` without `..`.
bool is_name(std::string_view text) noexcept;

/// Returns the text if it is a valid name; otherwise throws Errc::invalid_argument, which gives the grammar.
/// @param what  the thing being named, for the error: "drone", "parameter"
std::string require_name(std::string_view text, std::string_view what);

/// The same for the name of a port, which has no point: "camera.1.image" is the port "image" of "camera.1".
std::string require_port_name(std::string_view text, std::string_view what);
/// Is this text the drone, or `DRONE.PORT`?
bool belongs_to(std::string_view text, std::string_view drone) noexcept;

/// Shell-style match with `*` and `?`; the whole text must match.
bool matches_glob(std::string_view pattern, std::string_view text) noexcept;

/// The candidate most similar to `text` (by edit distance), or empty when none is similar.
template <class Range>
std::string nearest(std::string_view text, const Range& candidates);

/// Errc::not_found with `text`; its advice is the candidate most similar to `name`, if any.
/// @param otherwise  the advice when none is
Error no_such(const std::string& text, std::string_view name, const std::vector<std::string>& candidates,
              const std::string& otherwise = {});

/// Number of single-character edits (swapping two neighbours is one) that turn `a` into `b`.
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
