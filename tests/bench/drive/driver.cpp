// Rounds, laps, repetition of disturbed runs.
#include "driver.hpp"

#include "daemon.hpp"
#include "job.hpp"

#include "../harness/usage.hpp"

#include <fstream>
#include <iostream>
#include <regex>

namespace hive::bench {
namespace {

constexpr int most_repetitions = 2;
constexpr double repetitions_have = 0.25;  ///< of the budget
constexpr double timeout = 10;             ///< seconds; a run takes less than 2
constexpr Nanoseconds quiet_for = 250 * millisecond, wait_for_quiet = 750 * millisecond;

class Driving {
public:
    explicit Driving(const DriveOptions& options)
        : options_(options),
          only_(options.only),
          column_(options.column),
          daemon_(programs()),
          out_(options.out),
          end_(now_ns() + nanoseconds_of(options.budget))
    {
        if (!out_)
            throw std::runtime_error("cannot write " + options.out.string());
    }

    void run()
    {
        for (round_ = 1; round_ <= options_.rounds; ++round_) {
            const auto begin = now_ns();
            for (const auto& column : columns())
                if (std::regex_search(column.name, column_))
                    run_column(column);
            std::fprintf(stderr, "round %d: %d runs, %d of them repeated, %.0f s\n", round_, runs_, repeated_,
                         seconds_of(now_ns() - begin));
        }
        if (runs_ == 0)
            throw std::runtime_error("no row and column fits");
        if (left_out_ > 0)
            std::fprintf(stderr, "%d runs were left out: the time was up\n", left_out_);
    }

private:
    [[nodiscard]] bool wanted(const Row& row) const
    {
        return std::regex_search(row, only_) && present(row) && (daemon_.runs() || !row.starts_with("iceoryx"));
    }

    /// The rows that go once a round are dealt out to the laps, so that each has a limit beside it.
    void run_column(const Column& column)
    {
        for (int lap = 0; lap < options_.laps; ++lap) {
            for (const auto& row : column.pairs)
                run_row(row, column);
            for (auto i = static_cast<std::size_t>(lap); i < column.once.size();
                 i += static_cast<std::size_t>(options_.laps))
                run_row(column.once[i], column);
        }
    }

    void run_row(const Row& row, const Column& column)
    {
        if (!wanted(row))
            return;
        if (now_ns() > end_) {
            ++left_out_;
            return;
        }
        Json outcome = best_of_some(row, column);
        outcome.update({{"row", row}, {"column", column.name}, {"round", round_}, {"at", seconds_of(now_ns())}});
        out_ << outcome.dump() << std::endl;
        ++runs_;
    }

    /// A run that failed or was disturbed is repeated, while repetitions have time; the least disturbed counts.
    Json best_of_some(const Row& row, const Column& column)
    {
        Run run = run_of(row, column);
        run.frames = options_.frames;
        run.seconds = options_.seconds;
        run.timeout = timeout;
        const auto badness = [](const Json& outcome) {
            return (outcome.value("ok", false) ? 0.0 : 1000.0) + outcome.value("foreign", 999.0);
        };
        Json best = execute(run).value_or(Json::object());
        const auto begin = now_ns();
        for (int i = 0;
             i < most_repetitions && badness(best) > most_foreign && repeating_ < repetitions_have * options_.budget;
             ++i) {
            await_quiet();
            ++repeated_;
            Json again = execute(run).value_or(Json::object());
            if (badness(again) < badness(best))
                best = std::move(again);
        }
        repeating_ += seconds_of(now_ns() - begin);
        return best;
    }

    static void await_quiet()
    {
        for (const auto end = now_ns() + wait_for_quiet; now_ns() < end;) {
            const auto busy = machine_cpu();
            sleep_for(quiet_for);
            if ((machine_cpu() - busy) / seconds_of(quiet_for) < most_foreign)
                return;
        }
    }

    DriveOptions options_;
    std::regex only_, column_;
    Daemon daemon_;
    std::ofstream out_;
    Nanoseconds end_;
    double repeating_ = 0;  ///< seconds spent on repetitions
    int round_ = 0, runs_ = 0, repeated_ = 0, left_out_ = 0;
};

}  // namespace

void drive(const DriveOptions& options)
{
    if (options.out.has_parent_path())
        std::filesystem::create_directories(options.out.parent_path());
    Driving(options).run();
}

}  // namespace hive::bench
