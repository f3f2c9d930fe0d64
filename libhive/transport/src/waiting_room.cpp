// Chooses the next peer, and the one to evict when the room is full.
#include "waiting_room.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <sys/socket.h>

namespace hive::transport {

/// A peer that has left counts as well, since waiting for it is useless.
bool WaitingRoom::Waiting::has_spoken()
{
    char first = 0;
    spoken = spoken || ::recv(socket.get(), &first, 1, MSG_PEEK | MSG_DONTWAIT) >= 0;
    return spoken;
}

void WaitingRoom::enter(Peer peer)
{
    auto& own = hosts_[peer.host];
    own.push_back({std::move(peer.socket), ++last_number_});
    if (++size_ <= most || let_silent_go())
        return;
    auto& largest = std::ranges::max_element(hosts_, {}, [](const auto& host) { return host.second.size(); })->second;
    if (largest.size() > own.size()) {
        largest.pop_back();
        --size_;
    }
}

/// Peers that have sent something meanwhile stay.
bool WaitingRoom::let_silent_go()
{
    const auto silent = [](const Waiting& waiting) { return !waiting.spoken; };
    for (;;) {
        auto chosen = hosts_.end();
        std::pair<std::size_t, std::uint64_t> best;
        for (auto host = hosts_.begin(); host != hosts_.end(); ++host)
            if (const auto first = std::ranges::find_if(host->second, silent); first != host->second.end())
                if (const std::pair rank(host->second.size(), ~first->number); chosen == hosts_.end() || rank > best) {
                    chosen = host;
                    best = rank;
                }
        if (chosen == hosts_.end())
            return false;
        const auto first = std::ranges::find_if(chosen->second, silent);
        if (!first->has_spoken()) {
            take(chosen, first);
            return true;
        }
    }
}

bool WaitingRoom::spoken()
{
    for (auto& [host, waiting] : hosts_)
        if (std::ranges::any_of(waiting, &Waiting::has_spoken))
            return true;
    return false;
}

WaitingRoom::Peer WaitingRoom::next()
{
    const auto after = hosts_.upper_bound(last_);
    const auto find_spoken = [this](Host from, Host to) -> std::optional<Peer> {
        for (auto host = from; host != to; ++host)
            if (const auto who = std::ranges::find_if(host->second, &Waiting::has_spoken); who != host->second.end()) {
                last_ = host->first;
                return take(host, who);
            }
        return {};
    };
    if (auto peer = find_spoken(after, hosts_.end()))
        return std::move(*peer);
    if (auto peer = find_spoken(hosts_.begin(), after))
        return std::move(*peer);
    const auto turn = after == hosts_.end() ? hosts_.begin() : after;
    last_ = turn->first;
    return take(turn, turn->second.begin());
}

WaitingRoom::Peer WaitingRoom::take(Host host, std::deque<Waiting>::iterator who)
{
    Peer peer{host->first, std::move(who->socket)};
    host->second.erase(who);
    if (host->second.empty())
        hosts_.erase(host);
    --size_;
    return peer;
}

}  // namespace hive::transport
