// Ties a sink to the drone's parameters and its input.
#pragma once

#include "file_times.hpp"
#include "sink.hpp"

#include <hive/drone.hpp>

#include <memory>
#include <optional>
#include <string>

namespace writing {

/// A file that is or was being written.
struct File {
    std::string path;            ///< empty: none
    std::unique_ptr<Sink> sink;  ///< null when the file has ended
    FileTimes times = {};
    std::int64_t written = 0, later = 0;  ///< images
    std::chrono::microseconds last{0};    ///< the time of the last one
    std::string ended = {};               ///< how
};

/// On the user thread.
class WriteDrone {
public:
    explicit WriteDrone(hive::Drone& drone);
    void run();

private:
    void declare();
    void apply();
    void spare_what_was_written();
    void open();
    void end_former();
    void take(const hive::Event& event);
    void write(const hive::Event& event);
    void close(File& file, const std::string& how, const std::string& problem = "");
    void fail(const std::string& problem);
    void say();
    [[nodiscard]] Moment moment_of(const hive::Event& event) const;

    hive::Drone& drone_;
    hive::Output files_;
    bool remembered_;  ///< was `file` restored after a crash?
    std::string file_;
    bool overwrite_ = false;
    int quality_ = 80, count_ = 0;
    double fps_ = 0;

    File present_;
    /// The former file, until a set of `file` is committed: before that, the drone's code is called only to revert the
    /// parameters.
    std::optional<File> former_;
};

}  // namespace writing
