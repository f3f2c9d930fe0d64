// A file as the recorder and the reader use it: whole reads, whole writes, room taken ahead.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>

namespace hive::recording {

/// Owns the descriptor. What the system refuses is thrown as std::system_error.
class File {
public:
    static File open_to_read(const std::filesystem::path& path);
    /// A new empty file that only this user can read, or (with `overwrite`) a recording that was there emptied, unless
    /// another process records into it. The path is seen from `folder` and stays below it, over no symbolic link.
    static File create(const std::filesystem::path& folder, const std::filesystem::path& path, bool overwrite);
    ~File();
    File(File&& other) noexcept;
    File& operator=(File&&) = delete;

    [[nodiscard]] std::uint64_t size() const;
    /// False at the end of the file: `to` is not filled then.
    bool read(std::uint64_t offset, std::span<std::byte> to) const;
    void write(std::uint64_t offset, std::initializer_list<std::span<const std::byte>> parts);
    /// Takes disk space for the bytes of [from, upto), beyond the end too. False: this file system knows no such thing.
    bool reserve(std::uint64_t from, std::uint64_t upto);
    void truncate(std::uint64_t size);
    /// Until the data is on the disk. 0 or errno.
    [[nodiscard]] int sync() const noexcept;

private:
    explicit File(int descriptor) : descriptor_(descriptor) {}
    [[nodiscard]] bool is_empty_or_recording() const;

    int descriptor_;
};

}  // namespace hive::recording
