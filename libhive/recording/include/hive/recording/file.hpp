// A file for the recorder and the reader: complete reads and writes, and space reserved in advance.
#pragma once

#include <hive/platform/descriptor.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>

namespace hive::recording {

/// Owns the descriptor. Errors of the system are thrown as std::system_error.
class File {
public:
    static File open_to_read(const std::filesystem::path& path);
    /// Creates an empty file that only this user can read, or (with `overwrite`) truncates an existing recording,
    /// unless another process is writing it. The path is relative to `folder` and stays in it, without symbolic links.
    static File create(const std::filesystem::path& folder, const std::filesystem::path& path, bool overwrite);

    [[nodiscard]] std::uint64_t size() const;
    /// False at the end of the file: `to` is not filled then.
    bool read(std::uint64_t offset, std::span<std::byte> to) const;
    void write(std::uint64_t offset, std::initializer_list<std::span<const std::byte>> parts);
    /// Reserves disk space for the bytes of [from, upto), also beyond the end. False: not supported by this file
    /// system.
    bool reserve(std::uint64_t from, std::uint64_t upto);
    void truncate(std::uint64_t size);
    /// Waits until the data is on the disk. 0 or errno.
    [[nodiscard]] int sync() const noexcept;

private:
    explicit File(int descriptor) : descriptor_(descriptor) {}
    [[nodiscard]] bool is_empty_or_recording() const;

    platform::Descriptor descriptor_;
};

}  // namespace hive::recording
