// The log of a drone: standard error. When that is the drone's own file in the home directory, the file stays bounded.
#pragma once

#include <filesystem>

#include <spdlog/sinks/base_sink.h>

#include <mutex>
#include <string>

namespace hive {

/// Writes to standard error. Before a line would make the file NAME.log longer than `most_bytes`, its content moves to
/// NAME.log.1, replacing that file. The log is copied and truncated, not renamed, since libraries and the system write
/// to the same descriptor. Any other file, terminal or pipe is only written to. Each text becomes one line of at most
/// 4000 bytes before escaping, without control sequences for a terminal.
class BoundedLog final : public spdlog::sinks::base_sink<std::mutex> {
public:
    static constexpr long most_bytes = 4 * 1024 * 1024;

    explicit BoundedLog(std::filesystem::path file) : file_(std::move(file)) {}

private:
    void sink_it_(const spdlog::details::log_msg& message) override;
    void flush_() override {}
    void make_room(long bytes) const;

    std::filesystem::path file_;
};

}  // namespace hive
