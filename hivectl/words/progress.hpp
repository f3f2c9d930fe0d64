// Shows the progress of work from files on a terminal: "123 of 300 frames, 41 %, 24.3/s, 7 s left".
#pragma once

#include <hive/application.hpp>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace hivectl {

/// @param all  0: unknown
std::string progress_text(std::int64_t done, std::int64_t all, double per_second);

/// One line on stderr that is overwritten, if stderr is a terminal that stdout does not share; otherwise nothing.
class Progress {
public:
    using Clock = std::chrono::steady_clock;

    /// @param beside_results  stdout gets a line per event, so the progress line needs a terminal of its own
    Progress(hive::Application& application, bool beside_results);
    /// Erases the line.
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Counts a processed event of this capture.
    void note(const hive::Identity& identity);
    /// Sets the number of processed events of a source.
    void note(const std::string& source, std::int64_t done);

private:
    void advance(const std::string& source, std::int64_t done);
    void show();
    std::int64_t all_of(const std::string& source);

    hive::Application& application_;
    bool shown_;
    std::string source_;
    struct Place {
        std::int64_t epoch = 0, sequence = 0;
    };
    std::map<std::string, Place> places_;  ///< by source: the newest capture
    std::int64_t done_ = 0;                ///< position of source_
    std::int64_t work_ = 0, before_ = 0;   ///< captures of all sources: since the start, at the last line
    double per_second_ = 0;
    Clock::time_point last_ = Clock::now();
    std::map<std::string, std::int64_t> all_;  ///< by source
};

}  // namespace hivectl
