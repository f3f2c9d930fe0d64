// An outgoing event: immutable, with its header encoded once for all receivers; and the conversion of a packet back to
// an event.
#pragma once

#include <hive/event.hpp>
#include <hive/protocol/packet.hpp>
#include <hive/transfer.hpp>

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace hive::event {

/// Maximum number of shared or lossless stages that one event can pass.
inline constexpr std::size_t most_shares = 16;

/// Made on the emitting thread (which encodes the header), then read by the network side and the encoder thread.
class Emission {
public:
    /// @param complete  false: no receiver wanted the body when the event was emitted, so there is only the header
    /// @param own  of a lossless event: the share of this output, which every plain receiver gets at first Throws
    /// Errc::too_large when the header does not fit a packet, or receivers would reject it for its levels, keys or
    /// strings.
    explicit Emission(Event event, bool complete = true, std::optional<Share> own = {});

    [[nodiscard]] const Event& event() const noexcept { return event_; }
    [[nodiscard]] bool lossless() const noexcept { return event_.identity.lossless; }
    [[nodiscard]] std::size_t size() const noexcept { return event_.body.size(); }
    /// The share for plain receivers, if any.
    [[nodiscard]] const std::optional<Share>& own() const noexcept { return own_; }
    /// The same event for storage, which must not delay the acknowledgement of the event that it was made from.
    [[nodiscard]] std::shared_ptr<const Emission> without_ticket() const;
    /// The same event for error reports: no receiver gets it, so no limit applies. Its own share becomes `last`.
    [[nodiscard]] std::shared_ptr<const Emission> given_up(const std::optional<Share>& last) const;
    /// Can it be sent to a receiver with this delivery?
    [[nodiscard]] bool serves(Delivery delivery) const noexcept
    {
        return complete_ || delivery == Delivery::notification;
    }
    /// The packet that carries it; all receivers share one header, except those with their own share.
    [[nodiscard]] protocol::Packet packet(protocol::PacketType type, std::uint16_t channel,
                                          const std::optional<Share>& share = {}) const;

    /// The event in another encoding if it was made already, or null. A rendition has no ticket: it is kept as long as
    /// the event.
    [[nodiscard]] std::shared_ptr<const Emission> rendition(const std::string& encoding) const;
    void keep_rendition(const std::string& encoding, std::shared_ptr<const Emission> rendition) const;

private:
    struct Renditions {  ///< shared by the copies of an emission
        std::mutex mutex;
        std::map<std::string, std::shared_ptr<const Emission>> made;
    };
    Event event_;
    bool complete_;
    std::optional<Share> own_;
    std::shared_ptr<const std::string> header_;
    std::shared_ptr<Renditions> renditions_ = std::make_shared<Renditions>();
};

using EmissionPtr = std::shared_ptr<const Emission>;

/// The event in a packet of type event, notification or exception. Throws Errc::malformed.
Event event_from_packet(const protocol::Packet& packet);

}  // namespace hive::event
