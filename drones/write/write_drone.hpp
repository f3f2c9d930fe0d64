// Ties a sink to the drone's parameters and its input.
#pragma once

#include "file_times.hpp"
#include "sink.hpp"

#include <hive/drone.hpp>

#include <memory>
#include <string>

namespace writing {

/// On the user thread.
class WriteDrone {
public:
    explicit WriteDrone(hive::Drone& drone);
    void run();

private:
    void declare();
    void apply();
    void open();
    void take(const hive::Event& event);
    void write(const hive::Event& event);
    void close(const std::string& how, const std::string& problem = "");
    void fail(const std::string& problem);
    void say();
    [[nodiscard]] Moment moment_of(const hive::Event& event) const;

    hive::Drone& drone_;
    hive::Output files_;
    std::string file_;
    bool overwrite_ = false;
    int quality_ = 80, count_ = 0;
    double fps_ = 0;

    std::string opened_;
    std::unique_ptr<Sink> sink_;  ///< gone when the file has ended
    FileTimes times_;
    std::int64_t written_ = 0, later_ = 0;
    std::chrono::microseconds last_{0};
    std::string ended_;  ///< how
};

}  // namespace writing
