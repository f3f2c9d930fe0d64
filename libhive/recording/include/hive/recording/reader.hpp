// Reads a recording, complete or truncated, and checks every value before use.
#pragma once

#include <hive/recording/file.hpp>
#include <hive/recording/format.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace hive::recording {

/// The position of an event in the file.
struct Record {
    Prefix prefix;
    std::uint64_t offset = 0;
};

/// For one thread. If the file changes while it is read, errors are all that happens.
class Reader {
public:
    /// @throws std::runtime_error  no such file, or not a recording. A recording without an end is read up to its
    /// last complete record.
    explicit Reader(const std::filesystem::path& path);

    [[nodiscard]] const Summary& summary() const noexcept { return summary_; }
    /// What is wrong with the file, as far as it has been read; empty: nothing.
    [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
    /// Bytes of the file.
    [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

    /// The next event; nothing after the last complete one.
    std::optional<Record> next();
    /// Continues with an event that is not later than the first one at or after `time_us`.
    void seek(std::int64_t time_us);
    /// Its header. @throws std::runtime_error  its bytes are not those that were written
    [[nodiscard]] std::string text(const Record& record) const;
    /// Its body, into exactly as many bytes. @throws std::runtime_error  as above
    void body(const Record& record, std::span<std::byte> to) const;

private:
    bool read_end();
    bool read_end_at(std::uint64_t offset);
    void scan();
    bool learn(const Record& record);
    [[nodiscard]] std::optional<Prefix> prefix_at(std::uint64_t offset) const;
    void check(const Record& record);
    void damaged_at(std::uint64_t offset, const std::string& what);

    File file_;
    std::uint64_t size_;
    std::uint64_t at_ = 0;   ///< the next record
    std::uint64_t end_ = 0;  ///< of the events
    Summary summary_;
    std::vector<IndexEntry> index_;
    std::string problem_;
};

}  // namespace hive::recording
