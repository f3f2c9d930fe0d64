// Implements an output of this module: joins the receiver table to the links of the receivers.
#pragma once

#include <hive/event/dispatch.hpp>
#include <hive/event/encoding_choice.hpp>
#include <hive/event/link.hpp>
#include <hive/event/receiver_table.hpp>
#include <hive/interface.hpp>
#include <hive/status.hpp>

#include <atomic>
#include <functional>
#include <map>
#include <utility>
#include <vector>

namespace hive::event {

/// Network side, except wanted(), received(), asked(), fans_out() and shares().
class Outlet {
public:
    /// The events in progress at a receiving drone when it crashed, or when its lease expired.
    struct Failing {
        const Link& link;
        const std::string& receiver;
        Fate how;                         ///< lost_killed, lost_cut_off; passed_on: the lease
        std::vector<EmissionPtr> events;  ///< as sent; several for a stream or a stateful drone
    };
    struct Hooks {
        std::function<void()> changed;                   ///< wanted(), received(), asked() or backlogged()
        std::function<void(const EmissionPtr&)> failed;  ///< a shared event is given up
        std::function<void(const Failing&)> failed_at;
        /// The number of events at which this drone failed, as text; failures in runs before that of `newest` do not
        /// count.
        std::function<std::string(const Event* newest)> failures;
        /// Calls back once it is known whether the ends that this drone received still hold.
        std::function<void(std::chrono::milliseconds within, std::function<void()>)> make_sure;
        std::function<void(const EmissionPtr&, const Error&)>
            not_encoded;  ///< the encoder threw; the event goes as it is
        std::function<void(const std::string& peer, std::function<void()>)> on_encoder_thread;
        Dispatch::Run on_network_side;
    };
    /// @param drone    whose output it is
    /// @param carrier  the packet type that carries its events: event or exception
    Outlet(const protocol::Hello& drone, Port port, protocol::PacketType carrier, Encoder encoder, Hooks hooks);
    Outlet(const Outlet&) = delete;
    Outlet& operator=(const Outlet&) = delete;

    [[nodiscard]] const Port& port() const noexcept { return port_; }
    [[nodiscard]] protocol::PacketType carrier() const noexcept { return carrier_; }
    /// Throws Errc::type_mismatch, Errc::refused, or Errc::invalid_argument for an unknown encoding.
    void require_fit(const Link& link, const protocol::Registration& registration) const;
    [[nodiscard]] bool has(const Link& link, std::uint16_t channel) const { return ids_.contains({&link, channel}); }
    /// Number of registrations of this peer.
    [[nodiscard]] std::size_t receivers(const Link& link) const;
    /// Adds a registration that fits, on a free channel. `confirm` is called before the first event is sent.
    void add(const LinkPtr& link, std::uint16_t channel, const protocol::Registration& registration,
             const std::function<void(const Welcome&)>& confirm);
    void request(const Link& link, std::uint16_t channel, const protocol::Request& request);
    /// @return false when there is no such receiver
    bool remove(const Link& link, std::uint16_t channel);
    /// @param how  the outcome of the events that it was sent
    void link_closed(const Link& link, Fate how);
    void offer(const EmissionPtr& event, bool hold);
    /// Nothing more will come: every receiver gets the end after all its events.
    /// @param text  what is missing; empty: nothing, its regular end
    void end(const std::string& text);
    /// Something may come again: revokes the end at its receivers.
    void go_on();
    /// Tells all receivers that this drone is being stopped, so that no end waits for it.
    void say_leaving();
    void release_held();
    /// An earlier run of this drone had this subscriber. @param until  as for ReceiverTable
    void expect(const Subscriber& subscriber, std::optional<Clock::time_point> until);
    /// Ends the registrations of this drone, or of one of its inputs, and stops waiting for its return.
    /// @return number of registrations, places and groups that ended
    std::size_t forget(const std::string& drone);
    void tick();

    [[nodiscard]] std::vector<Subscriber> subscribers() const;
    /// Is there a receiver of bodies for which a source of lossless events waits? The network side.
    [[nodiscard]] bool awaited() const noexcept { return table_.awaited(); }
    [[nodiscard]] bool wanted() const noexcept { return wanted_.load(std::memory_order_relaxed); }
    /// True if it has receivers, even of headers only.
    [[nodiscard]] bool received() const noexcept { return received_.load(std::memory_order_relaxed); }
    [[nodiscard]] bool asked() const noexcept { return asked_.load(std::memory_order_relaxed); }
    [[nodiscard]] bool backlogged() const noexcept { return backlogged_.load(std::memory_order_relaxed); }
    /// Does each event go to several plain receivers of bodies?
    [[nodiscard]] bool fans_out() const noexcept { return fans_out_.load(std::memory_order_relaxed); }
    /// Does any receiver get bodies through shared memory?
    [[nodiscard]] bool shares() const noexcept { return shares_.load(std::memory_order_relaxed); }
    [[nodiscard]] bool timed() const { return table_.timed(); }
    /// Do events wait for a first receiver?
    [[nodiscard]] bool holds() const noexcept { return table_.holds(); }
    /// Without edges, of which there is one per receiver.
    [[nodiscard]] OutputStatus status() const;
    [[nodiscard]] std::vector<EdgeStatus> edges() const;

private:
    void require_modest(const protocol::Registration& registration) const;
    using Key = std::pair<const Link*, std::uint16_t>;
    struct Place {
        LinkPtr link;
        std::uint16_t channel;
        std::string receiver;
        std::int64_t registration;  ///< its epoch
        EncodingChoice encoding;
        bool data;                                ///< receives bodies
        bool stateful;                            ///< keeps state between events
        std::int64_t shared = 0, fallback = 0;    ///< bodies that went through shared memory, and that could not
        std::int64_t question = 0, answered = 0;  ///< the last question about the end, and the last answered
        Clock::time_point answer_until{};         ///< of the last question
    };
    void require_few_encodings(const Link& link, const protocol::Registration& registration) const;
    [[nodiscard]] EncodingChoice choice(const Link& link, const protocol::Registration& registration) const;
    [[nodiscard]] std::int64_t pid_of(const std::string& application) const;
    void transmit(const Send& send, const Emission& form);
    void transmit_end(ReceiverId receiver);
    void answer(ReceiverId receiver);
    static void send_end(const Place& place, const protocol::End& end);
    void execute(const Decisions& decisions);
    void tell_failed_at(const std::vector<FailedAt>& failed, Place& place, Fate how);
    ReceiverId detach(std::map<Key, ReceiverId>::iterator place);
    void refresh();

    Port port_;
    protocol::PacketType carrier_;
    Encoder encoder_;
    Hooks hooks_;
    ReceiverTable table_;
    Dispatch dispatch_;
    std::map<Key, ReceiverId> ids_;
    std::map<ReceiverId, Place> places_;
    std::map<std::string, std::int64_t> expected_;  ///< processes of applications that an earlier run had
    ReceiverId next_id_ = 0;
    std::int64_t produced_ = 0;
    std::int64_t last_emitted_us_ = 0;
    bool lossless_ = false;  ///< was the last emitted event lossless?
    protocol::End end_;
    std::atomic<bool> wanted_ = false, received_ = false, asked_ = false, backlogged_ = false, shares_ = false,
                      fans_out_ = false;
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace hive::event
