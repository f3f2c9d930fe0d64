// A connection to a peer that has said who it is: requests and their answers, channels of events.
#pragma once

#include <hive/event/clock.hpp>
#include <hive/protocol/messages.hpp>
#include <hive/transport/connection.hpp>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>

namespace hive::event {

/// What a request came to: a result object or an error.
using Outcome = std::variant<Json, Error>;
using OnOutcome = std::function<void(const Outcome&)>;

/// Network side. Owned by the module; ends with its connection.
class Link : public std::enable_shared_from_this<Link> {
public:
    struct Events {
        std::function<void(Link&)> opened;  ///< the peer's hello is here
        std::function<void(Link&, const protocol::Packet&, const Json&)>
            packet;                                       ///< registrations and requests of the peer
        std::function<void(Link&, const Error&)> closed;  ///< once, the last
    };
    /// Receives the packets (event, notification, exception) of one channel.
    using ChannelSink = std::function<void(const protocol::Packet&)>;

    /// @param pool  where the bodies of this module lie that a peer on this machine may read
    /// @param maps  whether this module can map what a peer shares
    Link(std::shared_ptr<transport::Connection> connection, const protocol::Hello& self, protocol::Limits limits,
         std::shared_ptr<transport::Pool> pool, bool maps);
    void start(Events events);

    [[nodiscard]] bool open() const noexcept { return open_; }
    [[nodiscard]] const protocol::Hello& peer() const noexcept { return peer_; }
    [[nodiscard]] transport::Connection& connection() noexcept { return *connection_; }
    /// Is the peer on this machine?
    [[nodiscard]] bool local() const { return connection_->local(); }

    /// Asks the peer; the outcome comes at the latest at the deadline (Errc::timeout), or when the link ends
    /// (Errc::connection_lost), or at once when the request is over the limits of a packet (Errc::too_large).
    void request(protocol::PacketType type, Json header, Body body, Clock::time_point deadline, OnOutcome on_outcome,
                 std::uint16_t channel = 0);
    /// Confirms a request. An answer that no peer would take (over the limit of a header) becomes Errc::too_large.
    void answer(std::int64_t id, const Outcome& outcome);
    /// Fails the requests whose deadline has passed.
    void expire(Clock::time_point now);
    [[nodiscard]] bool pending() const noexcept { return !pending_.empty(); }

    /// A channel number of this end for a registration; its packets go to the sink until it is released.
    std::uint16_t claim_channel(ChannelSink sink);
    void release_channel(std::uint16_t channel);
    void close(const Error& reason) { connection_->close(reason); }

    std::size_t under_way = 0;  ///< requests of the peer that this module has not answered; kept by the module

private:
    struct Pending {
        Clock::time_point deadline;
        OnOutcome on_outcome;
        std::string what;
    };
    void on_packet(const protocol::Packet& packet);
    void on_hello(const protocol::Packet& packet);
    void on_confirmation(const Json& header);
    void on_closed(const Error& reason);

    std::shared_ptr<transport::Connection> connection_;
    protocol::Hello self_, peer_;
    protocol::Limits limits_;
    std::shared_ptr<transport::Pool> pool_;
    Events events_;
    bool open_ = false;
    std::int64_t next_id_ = 0;
    std::uint16_t next_channel_ = 0;
    std::map<std::int64_t, Pending> pending_;
    std::map<std::uint16_t, ChannelSink> channels_;
};

using LinkPtr = std::shared_ptr<Link>;

}  // namespace hive::event
