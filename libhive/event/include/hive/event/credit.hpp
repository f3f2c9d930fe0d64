// The deliveries that one registration requested, was sent and has finished, and how many of them the connection has
// not yet taken (SPEC.md, section 5.2).
#pragma once

#include <hive/transfer.hpp>

#include <cstddef>
#include <cstdint>

namespace hive::event {

/// The counts in a receiver's request, all from its first delivery.
struct Progress {
    std::int64_t asked = 0;   ///< requested so far
    std::int64_t worked = 0;  ///< this many of those sent have been processed
    std::int64_t done = 0;    ///< this many need not be kept for it any more
};

/// Pure logic. The numbers of a peer are bounded by what it was sent: they allocate nothing.
class Credit {
public:
    static constexpr std::size_t lane_bytes = 64 * 1024;  ///< passed to the transport at a time, beyond one event
    static constexpr std::size_t most_lane_events = 64;
    /// Lossless events that a stream may have in progress; a synchronized receiver has its window.
    static constexpr std::int64_t most_streamed = 64;
    /// Unacknowledged deliveries beyond the window (or beyond most_streamed), whose results may be in transit.
    static constexpr std::int64_t most_under_way = 256;
    /// Unprocessed deliveries of a stream; beyond that live events wait, too. Not unacknowledged ones: an author may
    /// keep an event, which holds up the acknowledgements of all later ones.
    static constexpr std::int64_t most_unprocessed = 1 << 16;

    explicit Credit(const ConnectionOptions& options, std::int64_t held = 0)
        : streaming_(options.transfer == Transfer::streaming)
    {
        begin(options, 0, held);
    }
    /// The registration continues after the first `taken` deliveries; it counts as having requested one more window,
    /// minus the `held` deliveries that the receiver has not processed yet.
    void begin(const ConnectionOptions& options, std::int64_t taken, std::int64_t held);

    /// Applies the new counts, and returns the increase.
    Progress request(const Progress& told);
    void sent(std::size_t bytes);
    void written(std::size_t bytes);

    [[nodiscard]] bool open(bool lossless) const;
    [[nodiscard]] bool lane_free(std::size_t bytes) const;
    /// Deliveries that it requested and may get; of a stream, lossless ones.
    [[nodiscard]] std::int64_t missing() const;
    /// Must it acknowledge something before it gets more?
    [[nodiscard]] bool full() const { return sent_ - progress_.done >= window() + most_under_way; }
    [[nodiscard]] bool streaming() const { return streaming_; }
    /// Number of unacknowledged deliveries that were processed.
    [[nodiscard]] std::int64_t worked_in_hand() const { return progress_.worked - progress_.done; }
    [[nodiscard]] std::int64_t sent() const { return sent_; }
    [[nodiscard]] std::int64_t done() const { return progress_.done; }

private:
    [[nodiscard]] std::int64_t window() const { return streaming_ ? most_streamed : window_; }

    bool streaming_;
    std::int64_t window_ = 1, sent_ = 0;
    Progress progress_;
    std::size_t events_in_lane_ = 0, bytes_in_lane_ = 0;
};

}  // namespace hive::event
