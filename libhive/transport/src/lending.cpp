// Lends slots to a peer, and reclaims them.
#include "lending.hpp"

#include <algorithm>

namespace hive::transport {
namespace {

/// A peer that was disconnected for inactivity may only be suspended, and still use an image.
constexpr std::chrono::seconds kept_after_cut{10};

}  // namespace

std::optional<protocol::Reference> Lending::lend(const Body& body)
{
    const auto reference = pool_->find(body);
    if (!reference)
        return {};
    const auto segment = reference->slot.segment;
    const auto& known_segment = segments_.try_emplace(segment, pool_->offer(segment).first).first->second;
    if (known_segment.slot_size > protocol::most_slot_size(protocol::Limits{}.body))
        return {};  // no peer would accept it
    const auto slots = known_segment.slots;
    const auto held = std::ranges::count_if(lent_, [&](const auto& row) { return row.first.segment == segment; });
    const auto known = lent_.find(reference->slot);
    if (known == lent_.end() && static_cast<std::uint32_t>(held) >= slots - slots / 4)
        return {};
    auto& lent = lent_[reference->slot];
    lent.body = body;
    ++lent.times;
    return reference;
}

std::optional<std::pair<protocol::Segment, int>> Lending::offer(const protocol::Reference& reference)
{
    if (!offered_.insert(reference.slot.segment).second)
        return {};
    return pool_->offer(reference.slot.segment);
}

void Lending::released(const std::vector<protocol::Slot>& slots)
{
    for (const auto& slot : slots)
        if (const auto found = lent_.find(slot); found != lent_.end() && --found->second.times == 0)
            lent_.erase(found);
}

void Lending::end(bool by_peer)
{
    std::vector<Body> bodies;
    for (auto& [slot, lent] : lent_)
        bodies.push_back(std::move(lent.body));
    lent_.clear();
    if (!by_peer && !bodies.empty())
        pool_->keep(std::move(bodies), Pool::Clock::now() + kept_after_cut);
}

}  // namespace hive::transport
