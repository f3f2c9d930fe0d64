// One segment of another process, mapped for reading.
#pragma once

#include <hive/protocol/messages.hpp>
#include <hive/transport/descriptor.hpp>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace hive::transport {

class Mapping {
public:
    /// Throws Errc::malformed when the peer could still shrink it or let others write it, or when it is smaller than it
    /// says; Errc::io when the system refuses.
    static std::shared_ptr<Mapping> map(const protocol::Segment& offered, const Descriptor& descriptor);
    ~Mapping();
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;

    /// The bytes that a reference names; throws Errc::malformed when they are not all inside one slot, Errc::too_large
    /// when they are over `most`.
    [[nodiscard]] std::span<const std::byte> bytes(const protocol::Reference& reference, std::uint64_t most);
    /// Puts a private copy in the place of a slot, at the same addresses; what the producer does there is no longer
    /// seen.
    void make_private(std::uint32_t index) noexcept;

private:
    Mapping(const protocol::Segment& segment, std::byte* base);
    [[nodiscard]] std::byte* at(std::uint32_t index) const noexcept { return base_ + index * segment_.slot_size; }

    protocol::Segment segment_;
    std::byte* base_;
    std::vector<bool> seen_;  ///< slots whose pages are in this process's tables
};

}  // namespace hive::transport
