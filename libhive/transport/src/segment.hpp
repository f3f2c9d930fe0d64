// One segment of a pool: a sealed memfd, mapped for writing only by its producer, cut into slots of one size.
#pragma once

#include <hive/transport/descriptor.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace hive::transport {

/// Guarded by the pool's mutex.
class Segment {
public:
    /// Returns nothing if the operating system refuses.
    static std::unique_ptr<Segment> create(std::size_t slot_size, std::uint32_t slots);
    ~Segment();
    Segment(const Segment&) = delete;
    Segment& operator=(const Segment&) = delete;

    [[nodiscard]] int descriptor() const noexcept { return descriptor_.get(); }
    [[nodiscard]] std::size_t slot_size() const noexcept { return slot_size_; }
    [[nodiscard]] std::uint32_t slots() const noexcept { return static_cast<std::uint32_t>(generations_.size()); }
    [[nodiscard]] std::uint32_t backed() const noexcept { return backed_; }
    [[nodiscard]] std::uint32_t in_use() const noexcept { return backed_ - static_cast<std::uint32_t>(free_.size()); }
    [[nodiscard]] bool has_free() const noexcept { return !free_.empty(); }
    [[nodiscard]] std::byte* at(std::uint32_t index) const noexcept { return base_ + index * slot_size_; }
    [[nodiscard]] std::uint64_t generation(std::uint32_t index) const { return generations_[index]; }
    /// Are these bytes in this segment?
    [[nodiscard]] bool contains(std::span<const std::byte> bytes) const noexcept;
    [[nodiscard]] std::size_t offset(const std::byte* byte) const noexcept
    {
        return static_cast<std::size_t>(byte - base_);
    }

    /// Backs one more slot with memory; false if there is none.
    bool back_one() noexcept;
    /// Takes the free slot that was used last, in a new generation.
    std::uint32_t take();
    void give_back(std::uint32_t index) noexcept { free_.push_back(index); }

private:
    Segment(Descriptor descriptor, std::byte* base, std::size_t slot_size, std::uint32_t slots);
    [[nodiscard]] std::size_t size() const noexcept { return slot_size_ * generations_.size(); }

    Descriptor descriptor_;
    std::byte* base_;
    std::size_t slot_size_;
    std::vector<std::uint64_t> generations_;
    std::vector<std::uint32_t> free_;  ///< the last one first; has capacity for all, so that returning cannot fail
    std::uint32_t backed_ = 0;
};

}  // namespace hive::transport
