// Who holds which slot of the peer.
#include "borrowing.hpp"

#include "mapping.hpp"

#include <mutex>

namespace hive::transport {
namespace {

constexpr std::size_t most_segments = 64;
constexpr std::uint64_t most_mapped_bytes = 16ULL << 30;  // addresses, not memory

}  // namespace

/// What is held and what is to be given back. It outlives the connection, kept by the bodies.
class Borrowed {
public:
    explicit Borrowed(std::function<void()> on_return) : on_return_(std::move(on_return)) {}

    void hold(const std::shared_ptr<Mapping>& mapping, const protocol::Slot& slot)
    {
        const std::lock_guard lock(mutex_);
        auto& held = held_[slot];
        held.mapping = mapping;
        ++held.times;
    }
    void let_go(const protocol::Slot& slot) noexcept
    {
        const std::lock_guard lock(mutex_);
        const auto found = held_.find(slot);
        if (--found->second.times == 0)
            held_.erase(found);
        if (!on_return_)
            return;
        returns_.push_back(slot);
        if (returns_.size() == 1)
            on_return_();
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
                mapping->make_private(slot.index);
    }

private:
    struct Held {
        std::weak_ptr<Mapping> mapping;  // the bodies keep it
        int times = 0;
    };
    std::mutex mutex_;
    std::function<void()> on_return_;  ///< empty: the connection has ended
    std::map<protocol::Slot, Held> held_;
    std::vector<protocol::Slot> returns_;
};

Borrowing::Borrowing(std::function<void()> on_return) : borrowed_(std::make_shared<Borrowed>(std::move(on_return))) {}

Borrowing::~Borrowing() { end(); }

void Borrowing::end() noexcept { borrowed_->end(); }

void Borrowing::map(const protocol::Segment& offered, Descriptor descriptor)
{
    if (!descriptor)
        throw Error(Errc::malformed, "segment: no descriptor came with it");
    if (mappings_.contains(offered.id) || mappings_.size() == most_segments)
        throw Error(Errc::malformed, "segment: number " + std::to_string(offered.id) + " a second time, or more than "
                                         + std::to_string(most_segments));
    mapped_bytes_ += offered.slots * offered.slot_size;
    if (mapped_bytes_ > most_mapped_bytes)
        throw Error(Errc::too_large,
                    "segment: more than " + std::to_string(most_mapped_bytes) + " bytes of shared memory");
    mappings_[offered.id] = Mapping::map(offered, descriptor);
}

Body Borrowing::resolve(const protocol::Reference& reference, std::uint64_t most)
{
    const auto found = mappings_.find(reference.slot.segment);
    if (found == mappings_.end())
        throw Error(Errc::malformed,
                    "a reference to segment " + std::to_string(reference.slot.segment) + ", which was not offered");
    const auto bytes = found->second->bytes(reference, most);
    borrowed_->hold(found->second, reference.slot);
    const auto owner =
        std::shared_ptr<const void>(bytes.data(), [mapping = found->second, borrowed = borrowed_,
                                                   slot = reference.slot](const void*) { borrowed->let_go(slot); });
    return Body::in_foreign_memory(bytes, owner);
}

std::vector<protocol::Slot> Borrowing::take_returns() { return borrowed_->take_returns(); }

}  // namespace hive::transport
