// Queues peers while all slots of a listener are taken, by their host and whether they have sent anything.
#pragma once

#include <hive/transport/descriptor.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>

namespace hive::transport {

/// Hosts take turns, however many peers come from one, and peers that have sent something come before silent ones,
/// since an honest peer sends its hello at once.
class WaitingRoom {
public:
    static constexpr std::size_t most = 192;

    struct Peer {
        std::string host;
        Descriptor socket;
    };
    /// Adds a peer. If the room is full, evicts the oldest silent peer of the host with the most peers. If none is
    /// silent, and another host than the new peer's has the most, evicts the newest peer of that host.
    void enter(Peer peer);
    [[nodiscard]] bool full() const { return size_ > most; }
    [[nodiscard]] bool empty() const { return hosts_.empty(); }
    [[nodiscard]] std::size_t size() const { return size_; }
    /// Has any peer here sent something?
    bool spoken();
    /// Takes the first peer that has sent something, or else any, of the host whose turn it is. The room must not be
    /// empty.
    Peer next();

private:
    struct Waiting {
        Descriptor socket;
        std::uint64_t number;  ///< in the order of arrival
        bool spoken = false;   ///< at the last check
        bool has_spoken();
    };
    using Host = std::map<std::string, std::deque<Waiting>>::iterator;
    bool let_silent_go();
    Peer take(Host host, std::deque<Waiting>::iterator who);

    std::map<std::string, std::deque<Waiting>> hosts_;  ///< hosts with peers here
    std::string last_;                                  ///< the host of the last turn
    std::size_t size_ = 0;
    std::uint64_t last_number_ = 0;
};

}  // namespace hive::transport
