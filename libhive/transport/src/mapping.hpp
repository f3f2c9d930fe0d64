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
    /// Throws Errc::malformed when the peer could still shrink it or let others write it, when it is smaller than it
    /// says, or of huge pages; Errc::io when the system refuses.
    static std::shared_ptr<Mapping> map(const protocol::Segment& offered, const Descriptor& descriptor);
    ~Mapping();
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;

    /// Throws Errc::malformed when the bytes that a reference names are not all inside one slot, Errc::too_large when
    /// they are over `most`. Touches nothing.
    void check(const protocol::Reference& reference, std::uint64_t most) const;
    /// The bytes of a reference that was checked. Throws Errc::io when some of them are not in memory: whoever read
    /// them would be charged for pages that nobody ever wrote.
    [[nodiscard]] std::span<const std::byte> bytes(const protocol::Reference& reference);
    /// Puts a private copy in the place of the pages of some bytes, at the same addresses; what the producer does there
    /// is no longer seen.
    void make_private(std::span<const std::byte> bytes) noexcept;

private:
    Mapping(const protocol::Segment& segment, std::byte* base);
    /// Where bytes lie, and the rest of their first and last page.
    [[nodiscard]] static std::span<std::byte> pages_of(std::span<const std::byte> bytes) noexcept;

    protocol::Segment segment_;
    std::byte* base_;
    std::vector<std::span<const std::byte>> seen_;  ///< of each slot: what is known to be in memory
};

}  // namespace hive::transport
