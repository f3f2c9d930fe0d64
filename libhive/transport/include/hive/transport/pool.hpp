// Memory for bodies that other processes of this machine can read: slots of sealed memfd segments, lent and reclaimed.
#pragma once

#include <hive/body.hpp>
#include <hive/platform/clock.hpp>
#include <hive/protocol/messages.hpp>

#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace hive::transport {

class Segment;

/// Only this process keeps account of who holds which slot; receivers can neither write to a segment nor shrink it. The
/// slot used last is reused first, because it is still in the cache. Slots are backed by memory before they are lent,
/// so that a shortage is a return value and not a signal. Backed memory stays until the pool and the last body in it
/// are gone. From any thread.
class Pool : public std::enable_shared_from_this<Pool> {
public:
    using Clock = platform::SteadyClock;

    struct Limits {
        std::size_t bytes;  ///< maximum of backed memory, over all segments
        std::size_t segment_bytes =
            32u << 20;  ///< a segment has 8 slots, or as many as fit into this size, at most 128
    };
    /// A quarter of the machine's memory.
    static Limits default_limits();
    /// Smaller bodies are cheaper inside a packet.
    static constexpr std::size_t least_body = 4096;

    explicit Pool(Limits limits = default_limits());
    ~Pool();
    Pool(const Pool&) = delete;
    Pool& operator=(const Pool&) = delete;

    /// A slot, or part of one, to fill. Nothing when the pool is used up or memory is short; such refusals are counted.
    std::optional<Loan> loan(std::size_t bytes);
    /// A copy of the body in this pool; the body itself if it is there already, is too small, or does not fit.
    Body copied_in(const Body& body);
    /// The location of a body; nothing if it is not in this pool.
    [[nodiscard]] std::optional<protocol::Reference> find(const Body& body) const;
    /// What a receiver needs to map a segment. The descriptor stays open as long as the pool lives.
    [[nodiscard]] std::pair<protocol::Segment, int> offer(std::uint32_t segment) const;
    /// Keeps bodies until then, since their borrower may still be reading.
    void keep(std::vector<Body> bodies, Clock::time_point until);
    /// The producer ends: nothing is kept from now on. Call it before the last reference is dropped (kept bodies hold
    /// the pool).
    void end();

    struct Usage {
        std::size_t backed_bytes = 0, slots_in_use = 0;
        std::int64_t refused = 0;  ///< failed loans
    };
    [[nodiscard]] Usage usage() const;

private:
    struct Kept {
        std::vector<Body> bodies;
        Clock::time_point until;
    };
    std::optional<Loan> take_slot(std::size_t bytes);
    Segment* segment_for(std::size_t slot_size);
    bool back_one(Segment& segment);
    void give_back(std::uint32_t segment, std::uint32_t index) noexcept;
    std::vector<Kept> expired();

    const Limits limits_;
    mutable std::mutex mutex_;                        ///< guards all members below
    std::vector<std::unique_ptr<Segment>> segments_;  ///< a segment's id is its index
    std::deque<Kept> kept_;
    bool ended_ = false;
    std::size_t backed_bytes_ = 0;
    std::int64_t refused_ = 0;
};

}  // namespace hive::transport
