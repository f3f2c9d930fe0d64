// Solves the assignment problem: pairs rows with columns at the minimum total cost.
#pragma once

#include <cstddef>
#include <vector>

namespace track {

/// The cost of pairing each row with each column.
class CostTable {
public:
    CostTable(std::size_t rows, std::size_t columns) : columns_(columns), costs_(rows * columns) {}

    [[nodiscard]] std::size_t rows() const { return columns_ == 0 ? 0 : costs_.size() / columns_; }
    [[nodiscard]] std::size_t columns() const { return columns_; }
    [[nodiscard]] double& at(std::size_t row, std::size_t column) { return costs_[row * columns_ + column]; }
    [[nodiscard]] double at(std::size_t row, std::size_t column) const { return costs_[row * columns_ + column]; }

private:
    std::size_t columns_;
    std::vector<double> costs_;
};

struct Pair {
    std::size_t row, column;
    bool operator==(const Pair&) const = default;
};

/// As many pairs as the shorter side has, no row and no column twice, with the minimum sum of costs (which are finite).
/// Sorted by row; the same costs give the same pairs. Takes time in proportion to (shorter side)^2 x (longer side).
/// Source: H. W. Kuhn, "The Hungarian method for the assignment problem" (1955), in the form with shortest augmenting
/// paths.
std::vector<Pair> assign(const CostTable& costs);

}  // namespace track
