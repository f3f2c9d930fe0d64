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
    /// Throws Errc::malformed when the peer could still shrink it or make it writable, when it is smaller than
    /// announced, or has huge pages; Errc::io when the system refuses.
    static std::shared_ptr<Mapping> map(const protocol::Segment& offered, const Descriptor& descriptor);
    ~Mapping();
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;

    /// Throws Errc::malformed when the bytes of a reference are not all inside one slot, Errc::too_large when they are
    /// over `most`. Touches no page.
    void check(const protocol::Reference& reference, std::uint64_t most) const;
    /// The bytes of a checked reference. Throws Errc::io when some of them are not in memory: reading them would
    /// allocate pages at the reader's cost.
    [[nodiscard]] std::span<const std::byte> bytes(const protocol::Reference& reference);
    /// Replaces the pages of some bytes by a private copy at the same addresses, which hides later writes of the
    /// producer.
    void make_private(std::span<const std::byte> bytes) noexcept;

private:
    Mapping(const protocol::Segment& segment, std::byte* base);
    /// The bytes extended to whole pages.
    [[nodiscard]] static std::span<std::byte> pages_of(std::span<const std::byte> bytes) noexcept;

    protocol::Segment segment_;
    std::byte* base_;
    std::vector<std::span<const std::byte>> seen_;  ///< per slot: the bytes known to be in memory
};

}  // namespace hive::transport
