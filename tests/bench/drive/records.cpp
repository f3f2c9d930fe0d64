// Reading runs and putting them together.
#include "records.hpp"

#include "driver.hpp"

#include "../harness/statistics.hpp"

#include <cmath>
#include <fstream>

namespace hive::bench {
namespace {

constexpr std::size_t enough_undisturbed = 3;

bool was_disturbed(const Json& run) { return run.value("foreign", 0.0) > most_foreign; }

double number(const Json& run, const std::string& key) { return run.at(key).get<double>(); }

}  // namespace

Records::Records(const std::filesystem::path& file)
{
    std::ifstream in(file);
    if (!in)
        throw std::runtime_error("cannot read " + file.string());
    for (std::string line; std::getline(in, line);) {
        Json record = Json::parse(line, nullptr, false);
        if (!record.is_object())
            throw std::runtime_error(file.string() + ": a line that is not JSON");
        if (record.contains("hive_to_bare"))
            workers_ = std::move(record);
        else if (record.contains("row"))
            runs_.push_back(std::move(record));
    }
}

Records::Selection Records::select(const Row& row, const std::string& column, const std::string& key) const
{
    Selection all, calm;
    for (const auto& run : runs_) {
        if (run.at("row") != row || run.at("column") != column || !run.value("ok", false) || !run.contains(key))
            continue;
        all.runs.push_back(&run);
        if (!was_disturbed(run))
            calm.runs.push_back(&run);
    }
    if (calm.runs.size() == all.runs.size() || calm.runs.size() >= enough_undisturbed)
        return calm;
    all.disturbed = true;
    return all;
}

std::optional<Figure> Records::value(const Row& row, const std::string& column, const std::string& key) const
{
    const auto selection = select(row, column, key);
    std::vector<double> values;
    for (const auto* run : selection.runs)
        values.push_back(number(*run, key));
    if (values.empty())
        return std::nullopt;
    return Figure{median(values), values.size(), selection.disturbed};
}

std::optional<Figure> Records::p99(const Row& row, const std::string& column) const
{
    const auto selection = select(row, column, "samples");
    std::vector<double> samples;
    for (const auto* run : selection.runs)
        for (const auto& sample : run->at("samples"))
            samples.push_back(sample.get<double>());
    if (samples.empty())
        return value(row, column, "p99");
    return Figure{percentile(samples, 0.99), selection.runs.size(), selection.disturbed};
}

std::optional<Figure> Records::ratio(const Row& row, const Row& limit, const std::string& column,
                                     const std::string& key) const
{
    const auto mine = select(row, column, key), theirs = select(limit, column, key);
    std::vector<double> ratios;
    for (const auto* run : mine.runs) {
        const auto distance = [&](const Json* other) { return std::abs(number(*other, "at") - number(*run, "at")); };
        const auto nearest = std::min_element(theirs.runs.begin(), theirs.runs.end(),
                                              [&](auto* a, auto* b) { return distance(a) < distance(b); });
        if (nearest != theirs.runs.end() && number(**nearest, key) > 0)
            ratios.push_back(number(*run, key) / number(**nearest, key));
    }
    if (ratios.empty())
        return std::nullopt;
    return Figure{median(ratios), ratios.size(), mine.disturbed || theirs.disturbed};
}

bool Records::has(const Row& row, const std::string& column) const
{
    return std::any_of(runs_.begin(), runs_.end(), [&](const Json& run) {
        return (row.empty() || run.at("row") == row) && run.at("column") == column;
    });
}

std::vector<const Json*> Records::failed() const
{
    std::vector<const Json*> result;
    for (const auto& run : runs_)
        if (!run.value("ok", false))
            result.push_back(&run);
    return result;
}

std::size_t Records::disturbed() const
{
    return static_cast<std::size_t>(std::count_if(runs_.begin(), runs_.end(), was_disturbed));
}

}  // namespace hive::bench
