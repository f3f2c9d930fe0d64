// Who has come while all places of a listener were taken, by where they come from and whether they have spoken.
#pragma once

#include <hive/transport/descriptor.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>

namespace hive::transport {

/// Each address has its turn, however many come from another one, and whoever has sent something comes before those who
/// are silent: a peer with something to say sends its hello at once.
class WaitingRoom {
public:
    static constexpr std::size_t most = 192;

    struct Peer {
        std::string host;
        Descriptor socket;
    };
    /// One more than fit may come. Then the one that has been silent for longest goes, of a host that has most of them.
    /// When all have spoken, and the newcomer is not of a host that has most, the last of one that has most goes for
    /// it.
    void enter(Peer peer);
    [[nodiscard]] bool full() const { return size_ > most; }
    [[nodiscard]] bool empty() const { return hosts_.empty(); }
    /// Has somebody here spoken?
    bool spoken();
    /// Of those who have spoken, or else of all, the first of the host whose turn it is. Not when the room is empty.
    Peer next();

private:
    struct Waiting {
        Descriptor socket;
        std::uint64_t number;  ///< in the order of their coming
        bool spoken = false;   ///< as of the last look
        bool has_spoken();
    };
    using Host = std::map<std::string, std::deque<Waiting>>::iterator;
    bool let_silent_go();
    Peer take(Host host, std::deque<Waiting>::iterator who);

    std::map<std::string, std::deque<Waiting>> hosts_;  ///< that have somebody here
    std::string last_;                                  ///< whose turn it was
    std::size_t size_ = 0;
    std::uint64_t last_number_ = 0;
};

}  // namespace hive::transport
