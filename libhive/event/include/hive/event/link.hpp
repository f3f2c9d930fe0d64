// A connection to a peer that has sent its hello: requests and their answers, channels of events.
#pragma once

#include <hive/event/peer_clock.hpp>
#include <hive/protocol/messages.hpp>
#include <hive/protocol/permission.hpp>
#include <hive/result.hpp>
#include <hive/transport/connection.hpp>

#include <atomic>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace hive::event {

/// The outcome of a request: a result object or an error.
using Outcome = Result<Json>;
using OnOutcome = std::function<void(Outcome)>;

/// A request of the peer that waits to be taken up before its deadline, and then for its answer. Any thread.
class Asked {
public:
    Asked(protocol::PacketType type, std::int64_t id, Clock::time_point deadline)
        : type_(type), id_(id), deadline_(deadline)
    {
    }
    [[nodiscard]] protocol::PacketType type() const noexcept { return type_; }
    [[nodiscard]] std::int64_t id() const noexcept { return id_; }
    [[nodiscard]] Clock::time_point deadline() const noexcept { return deadline_; }
    /// Takes it up: from now on it does not expire. False: too late, the request must not be executed.
    bool begin() { return Clock::now() < deadline_ && moved(State::open, State::begun); }
    /// True once, when its deadline has passed before it was taken up.
    bool expire(Clock::time_point now) { return now >= deadline_ && moved(State::open, State::answered); }
    /// True for the first answer only.
    bool answer() { return state_.exchange(State::answered) != State::answered; }

private:
    enum class State { open, begun, answered };
    bool moved(State from, State to) { return state_.compare_exchange_strong(from, to); }

    protocol::PacketType type_;
    std::int64_t id_;
    Clock::time_point deadline_;
    std::atomic<State> state_ = State::open;
};

/// Network side. Owned by the module; ends with its connection.
class Link : public std::enable_shared_from_this<Link> {
public:
    struct Events {
        std::function<void(Link&)> opened;                           ///< the peer's hello has arrived
        std::function<void(Link&, const protocol::Packet&)> packet;  ///< registrations and requests of the peer
        std::function<void(Link&, const Error&)> closed;             ///< once, the last
    };
    /// Receives the packets (event, notification, exception, end) of one channel.
    using ChannelSink = std::function<void(const protocol::Packet&)>;

    /// Is this end the dialer or the listener?
    enum class End { dialed, accepted };

    /// @param pool  the bodies of this module that a peer on this machine may read
    /// @param maps  whether this module can map a peer's shared memory
    Link(std::shared_ptr<transport::Connection> connection, End end, const protocol::Hello& self,
         protocol::Limits limits, std::shared_ptr<transport::Pool> pool, bool maps);
    void start(Events events);

    [[nodiscard]] bool open() const noexcept { return open_; }
    [[nodiscard]] bool dialed() const noexcept { return end_ == End::dialed; }
    [[nodiscard]] const protocol::Hello& peer() const noexcept { return peer_; }
    [[nodiscard]] transport::Connection& connection() noexcept { return *connection_; }
    /// Is the peer on this machine?
    [[nodiscard]] bool local() const { return connection_->local(); }
    /// The peer's role, if the peer dialed.
    [[nodiscard]] const transport::Credentials& credentials() const { return connection_->credentials(); }

    /// For a peer on another machine; a peer on this machine has the same clock.
    [[nodiscard]] const PeerClock& peer_clock() const noexcept { return peer_clock_; }
    /// Requests the peer's time if the peer is on another machine and a measurement is due.
    void ask_time();

    /// Sends a request; the outcome comes at the latest at the deadline (Errc::timeout), or when the link ends
    /// (Errc::connection_lost), or at once when the request is over the limits of a packet (Errc::too_large) or not
    /// permitted to this end (Errc::not_permitted).
    void request(protocol::PacketType type, Json header, Body body, Clock::time_point deadline, OnOutcome on_outcome,
                 std::uint16_t channel = 0);
    /// Confirms a request. An answer over the limits of a header becomes Errc::too_large.
    void answer(std::int64_t id, Outcome outcome);
    /// Fails the requests whose deadline has passed.
    void expire(Clock::time_point now);
    /// Is any deadline pending?
    [[nodiscard]] bool pending() const noexcept { return !pending_.empty() || !asked.empty(); }

    /// A channel number of this end for a registration; its packets go to the sink until it is released.
    std::uint16_t claim_channel(ChannelSink sink);
    void release_channel(std::uint16_t channel);
    void close(const Error& reason) { connection_->close(reason); }
    /// Requests of the peer wait until each defer() is followed by a go_on().
    void defer() { ++defers_; }
    void go_on();
    /// Is no request in progress in either direction, and no output received?
    [[nodiscard]] bool idle() const noexcept
    {
        return open_ && !held && asked.empty() && pending_.empty() && channels_.empty();
    }
    /// When the peer last sent anything except heartbeats.
    [[nodiscard]] Clock::time_point used() const noexcept { return used_; }

    std::vector<std::shared_ptr<Asked>> asked;  ///< requests without an answer so far; maintained by the module
    bool held = false;                          ///< by code that will use this link again

private:
    struct Pending {
        Clock::time_point deadline;
        OnOutcome on_outcome;
        std::string what;
        Clock::time_point asked;
        std::int64_t asked_wall_us;
    };
    [[nodiscard]] bool wants(protocol::PacketType type, std::uint16_t channel) const;
    void on_packet(const protocol::Packet& packet);
    void take(const protocol::Packet& packet);
    void on_hello(const protocol::Packet& packet);
    void on_confirmation(Json header);
    void on_closed(const Error& reason);

    [[nodiscard]] protocol::Direction to_here() const;
    [[nodiscard]] protocol::Direction to_peer() const;

    std::shared_ptr<transport::Connection> connection_;
    End end_;
    protocol::Hello self_, peer_;
    protocol::Limits limits_;
    std::shared_ptr<transport::Pool> pool_;
    Events events_;
    PeerClock peer_clock_;
    bool asking_time_ = false;
    bool open_ = false;
    Clock::time_point used_{};
    int defers_ = 0;
    std::deque<protocol::Packet> deferred_;
    std::int64_t next_id_ = 0;
    std::uint16_t next_channel_ = 0;
    std::map<std::int64_t, Pending> pending_;
    std::map<std::uint16_t, std::shared_ptr<const ChannelSink>> channels_;
};

using LinkPtr = std::shared_ptr<Link>;

/// The host part of a peer's address, equal for all its connections: "pid 4711", "192.0.2.7".
std::string without_port(const std::string& place);

}  // namespace hive::event
