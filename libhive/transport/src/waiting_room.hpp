// Who has come while all places of a listener were taken, by where they come from.
#pragma once

#include <hive/transport/descriptor.hpp>

#include <cstddef>
#include <deque>
#include <map>
#include <string>

namespace hive::transport {

/// Each address has its turn, however many come from another one. No socket is looked at.
class WaitingRoom {
public:
    static constexpr std::size_t most = 192;

    struct Peer {
        std::string host;
        Descriptor socket;
    };
    /// One more than fit may come. If that is not of a host that has most, the last of one that has most goes for it.
    void enter(Peer peer);
    [[nodiscard]] bool full() const { return size_ > most; }
    /// The first of the host whose turn it is. Not when the room is empty.
    Peer next();
    [[nodiscard]] bool empty() const { return hosts_.empty(); }

private:
    std::map<std::string, std::deque<Descriptor>> hosts_;  ///< that have somebody here
    std::string last_;                                     ///< whose turn it was
    std::size_t size_ = 0;
};

}  // namespace hive::transport
