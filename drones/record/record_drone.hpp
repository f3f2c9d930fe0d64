// Connects the parameters and the input of the record drone to a writer, and records losses.
#pragma once

#include "condition.hpp"
#include "last_seconds.hpp"

#include <hive/drone.hpp>
#include <hive/recording/writer.hpp>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace record {

/// User thread.
class RecordDrone {
public:
    explicit RecordDrone(hive::Drone& drone);
    /// Runs until the drone is stopped; then writes the end of the file.
    void run();

private:
    struct Opened {  ///< the parameters with which a file was opened
        std::string file;
        bool around = false;  ///< clips around matching events only

        bool operator==(const Opened&) const = default;
    };

    void apply();
    void choose_folder();
    void spare_what_was_recorded();
    [[nodiscard]] std::string below_folder(const std::string& file) const;
    [[nodiscard]] std::unique_ptr<hive::recording::Writer> writer_of(const std::string& file) const;
    void put_back();
    void part();
    void open(const Opened& wanted);
    void begin(const std::string& file, std::unique_ptr<hive::recording::Writer> writer);
    void end(const std::string& text);
    void go_on();
    void close(const std::string& how);
    void finish(hive::recording::Writer& writer, const std::string& file, const std::string& how);
    void take(const hive::Event& event);
    void append(const hive::Event& event);
    [[nodiscard]] std::string failure_text() const;
    void take_around(const hive::Event& event);
    void begin_clip();
    [[nodiscard]] bool clip_is_over() const;
    std::chrono::microseconds look();
    void count_dropped();
    void say();
    [[nodiscard]] hive::recording::Limits limits() const;

    hive::Drone& drone_;
    bool remembered_;               ///< the file is that of before a crash
    std::filesystem::path folder_;  ///< the only folder for writing; empty: not chosen yet
    std::string file_;
    bool overwrite_ = false;
    double max_size_ = 0, max_duration_ = 0, sync_ = 1;
    std::string when_;  ///< empty: record everything; else clips around matching events
    double before_ = 5, after_ = 5;
    Condition condition_;
    LastSeconds last_;                                   ///< as long as no clip is being written
    std::chrono::steady_clock::time_point clip_ends_{};  ///< after the last event that fits
    Opened opened_;
    std::string writes_;  ///< the file of `writer_`, or of the last one; empty: none yet
    std::string ended_;   ///< how the last file ended with its source, until the next event
    std::unique_ptr<hive::recording::Writer> writer_;
    struct Dropped {
        std::int64_t seen = 0;   ///< the connection's own count, which restarts with the connection
        std::int64_t total = 0;  ///< since the file was opened
    };
    std::map<std::string, Dropped> dropped_;  ///< by sender of the connection
    struct Former {                           ///< the members of these names, as they were before another file was set
        Opened opened;
        std::string writes, ended;
        std::unique_ptr<hive::recording::Writer> writer;
        std::map<std::string, Dropped> dropped;
    };
    std::optional<Former> former_;  ///< until the joint set is committed or aborted
    std::chrono::steady_clock::time_point next_count_{};
};

}  // namespace record
