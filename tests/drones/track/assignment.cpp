// The assignment: the least sum there is, found by trying everything.
#include <assignment.hpp>
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

using track::assign;
using track::CostTable;
using track::Pair;

namespace {

double sum_of(const CostTable& costs, const std::vector<Pair>& pairs)
{
    return std::accumulate(pairs.begin(), pairs.end(), 0.0,
                           [&](double sum, const Pair& pair) { return sum + costs.at(pair.row, pair.column); });
}

/// The least sum over all ways to give each of the fewer a partner among the more.
double least_sum(const CostTable& costs)
{
    const bool wide = costs.columns() >= costs.rows();
    const std::size_t fewer = std::min(costs.rows(), costs.columns());
    std::vector<std::size_t> partners(std::max(costs.rows(), costs.columns()));
    std::iota(partners.begin(), partners.end(), 0);
    double least = 1e300;
    do {
        double sum = 0;
        for (std::size_t i = 0; i < fewer; ++i)
            sum += wide ? costs.at(i, partners[i]) : costs.at(partners[i], i);
        least = std::min(least, sum);
    } while (std::ranges::next_permutation(partners).found);
    return least;
}

CostTable random_costs(std::mt19937& random, std::size_t rows, std::size_t columns, bool few_values)
{
    CostTable costs(rows, columns);
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column)
            costs.at(row, column) =
                few_values ? static_cast<double>(random() % 3) : static_cast<double>(random() % 100000) / 1000 - 50;
    return costs;
}

}  // namespace

TEST_CASE("assignment: the sum is the least of all, for every shape up to 6x7, also with equal costs")
{
    std::mt19937 random(1);
    for (std::size_t rows = 1; rows <= 7; ++rows)
        for (std::size_t columns = 1; columns <= 6; ++columns)
            for (int round = 0; round < 12; ++round) {
                const CostTable costs = random_costs(random, rows, columns, round % 2 == 0);
                const auto pairs = assign(costs);
                CAPTURE(rows);
                CAPTURE(columns);
                CHECK(sum_of(costs, pairs) == doctest::Approx(least_sum(costs)));
                std::set<std::size_t> rows_used, columns_used;
                for (const Pair& pair : pairs) {
                    rows_used.insert(pair.row);
                    columns_used.insert(pair.column);
                }
                CHECK(pairs.size() == std::min(rows, columns));
                CHECK(rows_used.size() == pairs.size());
                CHECK(columns_used.size() == pairs.size());
            }
}

TEST_CASE("assignment: the best pair is given up when that is cheaper in all")
{
    CostTable costs(2, 2);
    costs.at(0, 0) = 1;
    costs.at(0, 1) = 2;
    costs.at(1, 0) = 2;
    costs.at(1, 1) = 9;
    CHECK(assign(costs) == std::vector<Pair>{{0, 1}, {1, 0}});
}

TEST_CASE("assignment: without rows or columns there are no pairs")
{
    CHECK(assign(CostTable(0, 5)).empty());
    CHECK(assign(CostTable(5, 0)).empty());
}

TEST_CASE("assignment: a table as large as a tracker makes it, whose best pairs are known")
{
    constexpr std::size_t size = 256;
    CostTable costs(size, size);
    for (std::size_t row = 0; row < size; ++row)
        for (std::size_t column = 0; column < size; ++column)
            costs.at(row, column) =
                (row * 7 + 3) % size == column ? 0.25 : 1 + static_cast<double>((row * 31 + column * 17) % 97);
    const auto pairs = assign(costs);
    REQUIRE(pairs.size() == size);
    for (const Pair& pair : pairs)
        CHECK((pair.row * 7 + 3) % size == pair.column);
}
