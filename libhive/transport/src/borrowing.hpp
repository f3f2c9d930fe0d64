// The receiving end of shared memory on one connection: maps offered segments, turns references into bodies, returns
// slots.
#pragma once

#include <hive/protocol/messages.hpp>
#include <hive/transport/descriptor.hpp>

#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace hive::transport {

class Mapping;
class Borrowed;

/// Bodies outlive the connection: when it ends, those that are still held become private copies, because the producer
/// reclaims its slots. Network side, except the bodies, which end on any thread.
class Borrowing {
public:
    /// @param on_return  called from any thread when the first slot waits to be returned; not after end()
    explicit Borrowing(std::function<void()> on_return);
    ~Borrowing();  ///< calls end()
    Borrowing(const Borrowing&) = delete;
    Borrowing& operator=(const Borrowing&) = delete;

    /// Maps a segment that the peer offers. Throws Errc::malformed when it is not sealed, too small, or one too many;
    /// memory that the peer can still shrink, or that is writable here, is never mapped. Throws Errc::too_large when
    /// its slots are larger than bodies of `most_body` bytes need, Errc::io when the system refuses.
    void map(const protocol::Segment& offered, Descriptor descriptor, std::uint64_t most_body);
    /// The body that a reference names. Throws Errc::malformed for an invalid location, Errc::too_large when it is over
    /// `most_body` bytes or over the limit of held bytes, Errc::io when it is not in memory.
    [[nodiscard]] Body resolve(const protocol::Reference& reference, std::uint64_t most_body);
    /// Returns an unneeded body untouched. Throws as resolve() for an invalid location.
    void decline(const protocol::Reference& reference, std::uint64_t most_body);
    /// The slots whose bodies have ended since the last call.
    [[nodiscard]] std::vector<protocol::Slot> take_returns();
    void end() noexcept;

private:
    [[nodiscard]] const std::shared_ptr<Mapping>& mapping_of(const protocol::Reference& reference,
                                                             std::uint64_t most_body) const;

    std::map<std::uint32_t, std::shared_ptr<Mapping>> mappings_;
    std::uint64_t mapped_bytes_ = 0;
    std::shared_ptr<Borrowed> borrowed_;
};

}  // namespace hive::transport
