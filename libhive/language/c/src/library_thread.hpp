// Marks code of the caller that runs on a thread of the library: a call that joins this thread must not run on it.
#pragma once

namespace hive::c {

/// While one lives, this thread runs code of the caller on a thread of the library.
class LibraryThread {
public:
    LibraryThread() noexcept { ++depth; }
    ~LibraryThread() { --depth; }
    LibraryThread(const LibraryThread&) = delete;
    LibraryThread& operator=(const LibraryThread&) = delete;

    [[nodiscard]] static bool is_this() noexcept { return depth > 0; }

private:
    static inline thread_local int depth = 0;
};

}  // namespace hive::c
