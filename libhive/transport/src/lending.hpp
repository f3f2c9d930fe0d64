// The sending end of shared memory on one connection: which slots the peer holds.
#pragma once

#include <hive/protocol/packet.hpp>
#include <hive/transport/pool.hpp>

#include <map>
#include <memory>
#include <set>
#include <vector>

namespace hive::transport {

/// Network side.
class Lending {
public:
    explicit Lending(std::shared_ptr<Pool> pool) : pool_(std::move(pool)) {}

    /// May this body go by reference: it lies in the pool, and the peer does not hold most of its kind already (who
    /// keeps everything must not leave the others without)?
    [[nodiscard]] std::optional<protocol::Reference> lend(const Body& body);
    /// The segment of a reference, if the peer does not know it yet.
    [[nodiscard]] std::optional<std::pair<protocol::Segment, int>> offer(const protocol::Reference& reference);
    /// The peer gives slots back. What it does not hold is ignored: a late answer of an earlier use.
    void released(const std::vector<protocol::Slot>& slots);
    /// The connection has ended. Whoever ended it himself knows that nobody reads there any more; else it is not known,
    /// and the slots stay as they are for a while.
    void end(bool by_peer);

private:
    struct Lent {
        Body body;
        int times = 0;
    };
    std::shared_ptr<Pool> pool_;
    std::set<std::uint32_t> offered_;
    std::map<std::uint32_t, protocol::Segment> segments_;  ///< what is known of each
    std::map<protocol::Slot, Lent> lent_;
};

}  // namespace hive::transport
