// Chooses segments and slots.
#include "segment.hpp"

#include <hive/transport/pool.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <unistd.h>

namespace hive::transport {
namespace {

constexpr std::size_t most_segments = 64;
constexpr std::size_t most_bytes = 1u << 30;  // of one body

/// Four sizes for each doubling, in whole pages: at most a fifth of a slot is unused.
std::size_t slot_size_for(std::size_t bytes)
{
    constexpr std::size_t page = 4096;
    const auto step = std::max(page, std::bit_floor(std::max<std::size_t>(bytes, 1)) / 4);
    return (std::max<std::size_t>(bytes, 1) + step - 1) / step * step;
}

}  // namespace

Pool::Limits Pool::default_limits()
{
    return {.bytes = static_cast<std::size_t>(::sysconf(_SC_PHYS_PAGES))
                     * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) / 4};
}

Pool::Pool(Limits limits) : limits_(limits) {}

Pool::~Pool() = default;

std::optional<Loan> Pool::loan(std::size_t bytes)
{
    const auto released = expired();  // destroyed after the lock, which returning a slot takes
    const std::lock_guard lock(mutex_);
    auto loan = take_slot(bytes);
    refused_ += loan ? 0 : 1;
    return loan;
}

std::optional<Loan> Pool::take_slot(std::size_t bytes)
{
    if (bytes > most_bytes)
        return {};
    Segment* const segment = segment_for(slot_size_for(bytes));
    if (!segment || (!segment->has_free() && !back_one(*segment)))
        return {};
    const auto id = static_cast<std::uint32_t>(std::ranges::find(segments_, segment, &std::unique_ptr<Segment>::get)
                                               - segments_.begin());
    const auto index = segment->take();
    std::byte* const at = segment->at(index);
    return Loan(std::span(at, bytes), std::shared_ptr<void>(at, [self = shared_from_this(), id, index](void*) {
                    self->give_back(id, index);
                }));
}

Segment* Pool::segment_for(std::size_t slot_size)
{
    for (const auto& segment : segments_)
        if (segment->slot_size() == slot_size)
            return segment.get();
    if (segments_.size() == most_segments)
        return nullptr;
    const auto slots = std::clamp<std::size_t>(limits_.segment_bytes / slot_size, 8, 128);
    auto segment = Segment::create(slot_size, static_cast<std::uint32_t>(slots));
    return segment ? segments_.emplace_back(std::move(segment)).get() : nullptr;
}

bool Pool::back_one(Segment& segment)
{
    if (backed_bytes_ + segment.slot_size() > limits_.bytes || !segment.back_one())
        return false;
    backed_bytes_ += segment.slot_size();
    return true;
}

void Pool::give_back(std::uint32_t segment, std::uint32_t index) noexcept
{
    const std::lock_guard lock(mutex_);
    segments_[segment]->give_back(index);
}

Body Pool::copied_in(const Body& body)
{
    if (body.size() < least_body || find(body))
        return body;
    auto room = loan(body.size());
    if (!room)
        return body;
    std::memcpy(room->data(), body.data(), body.size());
    return std::move(*room);
}

std::optional<protocol::Reference> Pool::find(const Body& body) const
{
    const std::lock_guard lock(mutex_);
    for (std::size_t id = 0; id < segments_.size(); ++id) {
        const Segment& segment = *segments_[id];
        if (body.empty() || !segment.contains(body.bytes()))
            continue;
        const auto offset = segment.offset(body.bytes().data());
        const auto index = static_cast<std::uint32_t>(offset / segment.slot_size());
        return protocol::Reference{{static_cast<std::uint32_t>(id), index, segment.generation(index)},
                                   offset % segment.slot_size(),
                                   body.size()};
    }
    return {};
}

std::pair<protocol::Segment, int> Pool::offer(std::uint32_t segment) const
{
    const std::lock_guard lock(mutex_);
    const Segment& offered = *segments_.at(segment);
    return {{.id = segment, .slots = offered.slots(), .slot_size = offered.slot_size()}, offered.descriptor()};
}

void Pool::keep(std::vector<Body> bodies, Clock::time_point until)
{
    const Kept kept{std::move(bodies), until};  // if not kept, destroyed after the lock, which returning takes
    const std::lock_guard lock(mutex_);
    if (!ended_)
        kept_.push_back(kept);
}

std::vector<Pool::Kept> Pool::expired()
{
    const std::lock_guard lock(mutex_);
    std::vector<Kept> expired;
    while (!kept_.empty() && kept_.front().until <= Clock::now()) {
        expired.push_back(std::move(kept_.front()));
        kept_.pop_front();
    }
    return expired;
}

void Pool::end()
{
    std::deque<Kept> kept;  // destroyed after the lock, which returning a slot takes
    const std::lock_guard lock(mutex_);
    kept.swap(kept_);
    ended_ = true;
}

Pool::Usage Pool::usage() const
{
    const std::lock_guard lock(mutex_);
    Usage usage{.backed_bytes = backed_bytes_, .slots_in_use = 0, .refused = refused_};
    for (const auto& segment : segments_)
        usage.slots_in_use += segment->in_use();
    return usage;
}

}  // namespace hive::transport
