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

    /// May this body be sent by reference: it is in the pool, and the peer does not hold most slots of this size
    /// already (a peer that keeps everything must leave slots for others)?
    [[nodiscard]] std::optional<protocol::Reference> lend(const Body& body);
    /// The segment of a reference, if the peer does not know it yet.
    [[nodiscard]] std::optional<std::pair<protocol::Segment, int>> offer(const protocol::Reference& reference);
    /// The peer returns slots. Slots that it does not hold are ignored: a late return of an earlier use.
    void released(const std::vector<protocol::Slot>& slots);
    /// The connection has ended. If the peer closed it, the peer no longer reads the slots; otherwise it may, and the
    /// slots are kept for 10 s.
    void end(bool by_peer);

private:
    struct Lent {
        Body body;
        int times = 0;
    };
    std::shared_ptr<Pool> pool_;
    std::set<std::uint32_t> offered_;
    std::map<std::uint32_t, protocol::Segment> segments_;  ///< by id
    std::map<protocol::Slot, Lent> lent_;
};

}  // namespace hive::transport
