// What a subscriber does with each frame: touch it, prove it whole and in order, note the times.
#pragma once

#include "board.hpp"
#include "run.hpp"

namespace hive::bench {

/// For the thread that receives.
class Receiving {
public:
    Receiving(const Run& run, Board& board);
    /// One frame came; false: it was the last.
    bool take(std::span<const std::byte> frame);

private:
    void finish();
    void measure(const FrameHeader& header, Nanoseconds available, Nanoseconds touched);
    void consumed(std::uint64_t sequence);

    bool intervals_;  ///< a sample is the time since the frame before: with one request for each frame, the round trip
    FrameCheck check_;
    Board& board_;
    Received& mine_;
    Usage usage_;
    std::uint64_t expected_ = 0;
};

}  // namespace hive::bench
