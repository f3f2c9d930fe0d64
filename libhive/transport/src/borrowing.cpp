// Counts which bodies hold which slots of the peer.
#include "borrowing.hpp"

#include "mapping.hpp"

#include <algorithm>
#include <mutex>

namespace hive::transport {
namespace {

constexpr std::size_t most_borrowed_segments = 64;
constexpr std::uint64_t most_mapped_bytes = 16ULL << 30;  // addresses, not memory
constexpr std::uint64_t most_held_bytes = 512ULL << 20;   // to be copied when the connection ends; six of the largest

}  // namespace

/// The held slots, and those to be returned. Outlives the connection, kept by the bodies.
class Borrowed {
public:
    explicit Borrowed(std::function<void()> on_return) : on_return_(std::move(on_return)) {}

    void hold(const std::shared_ptr<Mapping>& mapping, const protocol::Slot& slot, std::span<const std::byte> bytes)
    {
        const std::lock_guard lock(mutex_);
        if (held_bytes_ + bytes.size() > most_held_bytes)
            throw Error(Errc::too_large, "more than " + std::to_string(most_held_bytes)
                                             + " bytes of shared memory would be held at once");
        held_bytes_ += bytes.size();
        auto& held = held_[slot];
        held.mapping = mapping;
        held.bytes.push_back(bytes);
    }
    void let_go(const protocol::Slot& slot, std::span<const std::byte> bytes) noexcept
    {
        const std::lock_guard lock(mutex_);
        held_bytes_ -= bytes.size();
        const auto found = held_.find(slot);
        auto& all = found->second.bytes;
        all.erase(std::ranges::find_if(
            all, [&](const auto& each) { return each.data() == bytes.data() && each.size() == bytes.size(); }));
        if (all.empty())
            held_.erase(found);
        return_slot(slot);
    }
    void give_back(const protocol::Slot& slot)
    {
        const std::lock_guard lock(mutex_);
        return_slot(slot);
    }
    std::vector<protocol::Slot> take_returns()
    {
        const std::lock_guard lock(mutex_);
        return std::exchange(returns_, {});
    }
    void end() noexcept
    {
        const std::lock_guard lock(mutex_);
        if (!std::exchange(on_return_, {}))
            return;
        returns_.clear();
        for (const auto& [slot, held] : held_)
            if (const auto mapping = held.mapping.lock())
                for (const auto& bytes : held.bytes)
                    mapping->make_private(bytes);
    }

private:
    struct Held {
        std::weak_ptr<Mapping> mapping;  // the bodies keep it
        std::vector<std::span<const std::byte>> bytes;
    };
    void return_slot(const protocol::Slot& slot)
    {
        if (!on_return_)
            return;
        returns_.push_back(slot);
        if (returns_.size() == 1)
            on_return_();
    }

    std::mutex mutex_;
    std::function<void()> on_return_;  ///< empty: the connection has ended
    std::map<protocol::Slot, Held> held_;
    std::vector<protocol::Slot> returns_;
    std::uint64_t held_bytes_ = 0;
};

Borrowing::Borrowing(std::function<void()> on_return) : borrowed_(std::make_shared<Borrowed>(std::move(on_return))) {}

Borrowing::~Borrowing() { end(); }

void Borrowing::end() noexcept { borrowed_->end(); }

void Borrowing::map(const protocol::Segment& offered, Descriptor descriptor, std::uint64_t most_body)
{
    if (!descriptor)
        throw Error(Errc::malformed, "segment: without a descriptor");
    if (mappings_.contains(offered.id) || mappings_.size() == most_borrowed_segments)
        throw Error(Errc::malformed, "segment: number " + std::to_string(offered.id) + " a second time, or more than "
                                         + std::to_string(most_borrowed_segments));
    require_at_most("a slot of shared memory", offered.slot_size, protocol::most_slot_size(most_body));
    mapped_bytes_ += offered.slots * offered.slot_size;
    if (mapped_bytes_ > most_mapped_bytes)
        throw Error(Errc::too_large,
                    "segment: more than " + std::to_string(most_mapped_bytes) + " bytes of shared memory");
    mappings_[offered.id] = Mapping::map(offered, descriptor);
}

const std::shared_ptr<Mapping>& Borrowing::mapping_of(const protocol::Reference& reference,
                                                      std::uint64_t most_body) const
{
    const auto found = mappings_.find(reference.slot.segment);
    if (found == mappings_.end())
        throw Error(Errc::malformed,
                    "a reference to segment " + std::to_string(reference.slot.segment) + ", which was not offered");
    found->second->check(reference, most_body);
    return found->second;
}

Body Borrowing::resolve(const protocol::Reference& reference, std::uint64_t most_body)
{
    const auto& mapping = mapping_of(reference, most_body);
    const auto bytes = mapping->bytes(reference);
    borrowed_->hold(mapping, reference.slot, bytes);
    const auto owner =
        std::shared_ptr<const void>(bytes.data(), [mapping, borrowed = borrowed_, slot = reference.slot,
                                                   bytes](const void*) { borrowed->let_go(slot, bytes); });
    return Body::in_foreign_memory(bytes, owner);
}

void Borrowing::decline(const protocol::Reference& reference, std::uint64_t most_body)
{
    static_cast<void>(mapping_of(reference, most_body));  // only checked
    borrowed_->give_back(reference.slot);
}

std::vector<protocol::Slot> Borrowing::take_returns() { return borrowed_->take_returns(); }

}  // namespace hive::transport
