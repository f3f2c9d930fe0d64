// Sleeping on a word of shared memory, and waking who sleeps there: between processes, so without FUTEX_PRIVATE.
#pragma once

#include "clock.hpp"

#include <atomic>
#include <climits>
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace hive::bench {

using Word = std::atomic<std::uint32_t>;
static_assert(Word::is_always_lock_free && sizeof(Word) == 4);

/// Sleeps while the word has this value, at most for `timeout`; may return early.
inline void futex_wait(Word& word, std::uint32_t value, Nanoseconds timeout = second)
{
    const timespec time{timeout / second, timeout % second};
    ::syscall(SYS_futex, &word, FUTEX_WAIT, value, &time, nullptr, 0);
}

inline void futex_wake(Word& word) { ::syscall(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0); }

}  // namespace hive::bench
