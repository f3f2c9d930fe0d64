// The condition on the header of an event that starts a recording. Independent of Hive.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace record {

/// Comparisons that must all hold, joined by commas: "faces", "faces>=2", "objects.class=person,objects.score>0.8". A
/// field alone is true if it is present and not false, 0, null or empty. A dot selects a member of an object, or all
/// elements of an array, of which one must match. Compared with a number, an array counts as its length.
class Condition {
public:
    Condition() = default;
    /// "*" is always true. Throws std::invalid_argument.
    explicit Condition(const std::string& text);

    [[nodiscard]] bool holds(const nlohmann::json& header) const;

private:
    struct Comparison {
        std::vector<std::string> path;
        std::string operation;  ///< empty: the field alone
        std::string value;
    };
    static Comparison comparison(const std::string& text);
    static bool holds(const Comparison& one, const nlohmann::json& value, std::size_t step);
    static bool fits(const Comparison& one, const nlohmann::json& value);

    std::vector<Comparison> all_;
};

}  // namespace record
