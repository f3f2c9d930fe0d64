// An event on its way out: immutable, its header encoded once for all receivers; and the way back from a packet.
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

/// So many shared or lossless stages one event can go through.
inline constexpr std::size_t most_shares = 16;

/// An event that was emitted. Made on the thread that emits (which pays for encoding the header), then read by the
/// network side and the encoder thread.
class Emission {
public:
    /// @param complete  false: nobody wanted the body when it would have been made, so there is only the header
    /// @param own       of a lossless event: the share of this output, which every plain receiver is told at first
    /// Throws Errc::too_large when the header does not fit a packet, or no receiver would read it for its levels, keys
    /// or strings.
    explicit Emission(Event event, bool complete = true, std::optional<Share> own = {});

    [[nodiscard]] const Event& event() const noexcept { return event_; }
    [[nodiscard]] bool lossless() const noexcept { return event_.identity.lossless; }
    [[nodiscard]] std::size_t size() const noexcept { return event_.body.size(); }
    /// The share that plain receivers are told, if there is one.
    [[nodiscard]] const std::optional<Share>& own() const noexcept { return own_; }
    /// The same event for keeping: whoever only holds it must not hold up the acknowledgement of what it was made of.
    [[nodiscard]] std::shared_ptr<const Emission> without_ticket() const;
    /// The same event for those who report it: nobody gets it, so no limit counts. Its own share becomes the `last`.
    [[nodiscard]] std::shared_ptr<const Emission> given_up(const std::optional<Share>& last) const;
    /// May it go to a receiver of this kind?
    [[nodiscard]] bool serves(Delivery delivery) const noexcept
    {
        return complete_ || delivery == Delivery::notification;
    }
    /// The packet that carries it; the header is the same for all, but for those who are told a share of their own.
    [[nodiscard]] protocol::Packet packet(protocol::PacketType type, std::uint16_t channel,
                                          const std::optional<Share>& share = {}) const;

    /// The event in another encoding when it was made already, or null. A rendition has no ticket: it is kept as long
    /// as anybody keeps the event.
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
