// The runs of a file, and what they say together: medians, pooled percentiles, ratios of neighbours in time.
#pragma once

#include "plan.hpp"

#include <hive/json.hpp>

#include <filesystem>
#include <optional>
#include <vector>

namespace hive::bench {

/// A figure from several runs.
struct Figure {
    double value = 0;
    std::size_t runs = 0;    ///< or pairs of runs
    bool disturbed = false;  ///< others used the machine meanwhile
};

class Records {
public:
    /// Throws std::runtime_error.
    explicit Records(const std::filesystem::path& file);

    /// The median over the runs of a row in a column. @param key  of the JSON: "p50"
    [[nodiscard]] std::optional<Figure> value(const Row& row, const std::string& column, const std::string& key) const;
    /// Over the samples of all runs, where there are samples; otherwise the median of the runs' own.
    [[nodiscard]] std::optional<Figure> p99(const Row& row, const std::string& column) const;
    /// Each run against the run of `limit` that is nearest in time: the median of the quotients.
    [[nodiscard]] std::optional<Figure> ratio(const Row& row, const Row& limit, const std::string& column,
                                              const std::string& key) const;
    /// Is there a run of this row (empty: of any) in this column?
    [[nodiscard]] bool has(const Row& row, const std::string& column) const;

    /// What bench_two_workers wrote, if it did; null otherwise.
    [[nodiscard]] const Json& workers() const noexcept { return workers_; }
    [[nodiscard]] std::size_t size() const noexcept { return runs_.size(); }
    /// Runs that lost a frame, had a corrupt one, or did not come to an end.
    [[nodiscard]] std::vector<const Json*> failed() const;
    [[nodiscard]] std::size_t disturbed() const;

private:
    struct Selection {
        std::vector<const Json*> runs;
        bool disturbed = false;
    };
    /// The undisturbed runs when there are enough, otherwise all. Failed ones never count.
    [[nodiscard]] Selection select(const Row& row, const std::string& column, const std::string& key) const;

    std::vector<Json> runs_;
    Json workers_;
};

}  // namespace hive::bench
