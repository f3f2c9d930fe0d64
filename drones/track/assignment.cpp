// Places one row after the other. Each takes the cheapest chain of moves that ends at a free column.
#include "assignment.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

namespace track {
namespace {

/// For tables that are at least as wide as high. Prices keep every cost minus the prices of its row and column at 0 or
/// above, and at 0 for the pairs made so far: then these are the cheapest for the rows placed so far.
class Placement {
public:
    explicit Placement(const CostTable& costs)
        : costs_(costs), row_prices_(costs.rows()), column_prices_(costs.columns()), owners_(costs.columns())
    {
    }

    void place(std::size_t row)
    {
        Search search(costs_.columns());
        std::optional<std::size_t> reached;  // the column reached last; at first none
        for (auto from = std::optional(row); from; from = owners_[*reached])
            reached = advance(search, *from, reached);
        pay(search, row, *reached);
        for (auto column = reached; column; column = search.before[*column])
            owners_[*column] = search.before[*column] ? owners_[*search.before[*column]] : row;
    }

    [[nodiscard]] const std::vector<std::optional<std::size_t>>& owners() const { return owners_; }

private:
    struct Search {
        explicit Search(std::size_t columns)
            : distance(columns, std::numeric_limits<double>::infinity()), before(columns), reached(columns)
        {
        }
        std::vector<double> distance;                    ///< of the cheapest chain to each column
        std::vector<std::optional<std::size_t>> before;  ///< the column before it in that chain
        std::vector<bool> reached;
    };

    /// Extends the chain that reached `row` through column `via`; returns the nearest column that was not
    /// reached before.
    std::size_t advance(Search& search, std::size_t row, std::optional<std::size_t> via) const
    {
        const double so_far = via ? search.distance[*via] : 0;
        std::optional<std::size_t> nearest;
        for (std::size_t column = 0; column < costs_.columns(); ++column) {
            if (search.reached[column])
                continue;
            const double distance = so_far + costs_.at(row, column) - row_prices_[row] - column_prices_[column];
            if (distance < search.distance[column]) {
                search.distance[column] = distance;
                search.before[column] = via;
            }
            if (!nearest || search.distance[column] < search.distance[*nearest])
                nearest = column;
        }
        search.reached[*nearest] = true;
        return *nearest;
    }

    /// Changes the prices so that the chain from `row` to the column `end` has zero cost.
    void pay(const Search& search, std::size_t row, std::size_t end)
    {
        const double whole = search.distance[end];
        row_prices_[row] += whole;
        for (std::size_t column = 0; column < costs_.columns(); ++column)
            if (search.reached[column] && column != end) {
                row_prices_[*owners_[column]] += whole - search.distance[column];
                column_prices_[column] -= whole - search.distance[column];
            }
    }

    const CostTable& costs_;
    std::vector<double> row_prices_, column_prices_;
    std::vector<std::optional<std::size_t>> owners_;  ///< the row of each column
};

CostTable turned(const CostTable& costs)
{
    CostTable result(costs.columns(), costs.rows());
    for (std::size_t row = 0; row < costs.rows(); ++row)
        for (std::size_t column = 0; column < costs.columns(); ++column)
            result.at(column, row) = costs.at(row, column);
    return result;
}

}  // namespace

std::vector<Pair> assign(const CostTable& costs)
{
    std::vector<Pair> pairs;
    if (costs.rows() > costs.columns()) {
        for (const Pair& pair : assign(turned(costs)))
            pairs.push_back({pair.column, pair.row});
    } else {
        Placement placement(costs);
        for (std::size_t row = 0; row < costs.rows(); ++row)
            placement.place(row);
        for (std::size_t column = 0; column < costs.columns(); ++column)
            if (const auto row = placement.owners()[column])
                pairs.push_back({*row, column});
    }
    std::ranges::sort(pairs, {}, &Pair::row);
    return pairs;
}

}  // namespace track
