// Whose turn it is, and who has to go when the room is full.
#include "waiting_room.hpp"

#include <algorithm>

namespace hive::transport {

void WaitingRoom::enter(Peer peer)
{
    auto& own = hosts_[peer.host];
    own.push_back(std::move(peer.socket));
    if (++size_ <= most)
        return;
    auto& largest = std::ranges::max_element(hosts_, {}, [](const auto& host) { return host.second.size(); })->second;
    if (largest.size() > own.size()) {
        largest.pop_back();
        --size_;
    }
}

WaitingRoom::Peer WaitingRoom::next()
{
    auto turn = hosts_.upper_bound(last_);
    if (turn == hosts_.end())
        turn = hosts_.begin();
    last_ = turn->first;
    Peer peer{last_, std::move(turn->second.front())};
    turn->second.pop_front();
    if (turn->second.empty())
        hosts_.erase(turn);
    --size_;
    return peer;
}

}  // namespace hive::transport
