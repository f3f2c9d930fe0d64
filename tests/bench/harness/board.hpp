// The result block that the processes of one run share: a memfd that the roles inherit from the controller.
#pragma once

#include "frame.hpp"
#include "futex.hpp"
#include "usage.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <span>

namespace hive::bench {

constexpr std::size_t most_subscribers = 4;
constexpr std::uint32_t most_samples = 1u << 16;

/// What one receiver (subscriber or client) has measured. Written by it alone.
struct alignas(64) Received {
    std::atomic<bool> ready{false};          ///< a probe came
    std::atomic<bool> done{false};           ///< the end came, usage is final
    std::atomic<std::uint64_t> consumed{0};  ///< sequence after the last frame that was dealt with
    std::uint64_t frames = 0;                ///< measured ones
    std::uint64_t bad = 0;                   ///< corrupt, of the wrong size, or out of order
    Nanoseconds first = 0, last = 0;         ///< when those were dealt with
    Usage usage;                             ///< between them
    std::uint32_t samples = 0;
    std::array<float, most_samples> available;  ///< µs until the frame could be read
    std::array<float, most_samples> touched;    ///< µs until every line was read; of a round trip: all of it
};

struct Board {
    std::array<Received, most_subscribers> received;
    Word bell{0};                        ///< rung by receivers while the publisher waits
    std::atomic<bool> listening{false};  ///< the publisher waits
    std::atomic<bool> serving{false};    ///< the server is there
    std::atomic<bool> finished{false};   ///< results are complete
    std::uint64_t sent = 0;              ///< measured frames
    std::uint64_t stalls = 0;            ///< waits that took too long: frames are missing
    Usage usage;                         ///< of the publisher or the server

    template <class Predicate>
    [[nodiscard]] bool all(int subscribers, Predicate predicate) const
    {
        return std::all_of(received.begin(), received.begin() + subscribers, predicate);
    }
    /// What the slowest has consumed.
    [[nodiscard]] std::uint64_t consumed(int subscribers) const
    {
        std::uint64_t least = ~std::uint64_t{0};
        for (int i = 0; i < subscribers; ++i)
            least = std::min(least, received[static_cast<std::size_t>(i)].consumed.load());
        return least;
    }
};

/// Makes the block and says in the environment where children find it.
Board& make_board();
/// The block of the parent. Throws std::runtime_error.
Board& inherited_board();
/// The memfd for the frames of rows that bring their own shared memory, inherited like the board.
int frame_memory();

}  // namespace hive::bench
