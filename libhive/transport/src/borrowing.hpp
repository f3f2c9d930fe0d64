// The receiving end of shared memory on one connection: maps what the peer offers, makes bodies of references, gives
// slots back.
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
/// takes its slots back. Network side, but for the bodies, which end on any thread.
class Borrowing {
public:
    /// @param on_return  called from any thread when slots wait to be given back after none did; not after end()
    explicit Borrowing(std::function<void()> on_return);
    ~Borrowing();  ///< calls end()
    Borrowing(const Borrowing&) = delete;
    Borrowing& operator=(const Borrowing&) = delete;

    /// Maps a segment that the peer offers. Throws Errc::malformed when it is not sealed, too small, or one too many;
    /// nothing that the peer may still shrink or that may be written here is ever mapped. Throws Errc::too_large when
    /// its slots are over what bodies of `most_body` bytes need, Errc::io when the system refuses.
    void map(const protocol::Segment& offered, Descriptor descriptor, std::uint64_t most_body);
    /// The body that a reference names. Throws Errc::malformed when there is no such place, Errc::too_large when it is
    /// over `most_body` bytes or when the peer would have more held here than anybody needs, Errc::io when it is not
    /// in memory.
    [[nodiscard]] Body resolve(const protocol::Reference& reference, std::uint64_t most_body);
    /// Gives back, without touching it, what nobody here wants. Throws as resolve() for what is no such place.
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
