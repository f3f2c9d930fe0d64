// An output of this module at work: the receiver table joined to the links of the receivers.
#pragma once

#include <hive/event/link.hpp>
#include <hive/event/receiver_table.hpp>
#include <hive/interface.hpp>

#include <atomic>
#include <functional>
#include <map>
#include <utility>

namespace hive::event {

/// Network side, but for wanted() and asked().
class Outlet {
public:
    /// @param carrier    the packet type that carries its events: event or exception
    /// @param on_change  wanted(), asked() or backlogged() changed
    /// @param on_failed  a shared event is given up
    Outlet(Port port, protocol::PacketType carrier, std::function<void()> on_change, std::function<void(const EmissionPtr&)> on_failed);

    [[nodiscard]] const Port& port() const noexcept { return port_; }
    [[nodiscard]] protocol::PacketType carrier() const noexcept { return carrier_; }
    /// Throws Errc::type_mismatch or Errc::refused.
    void require_fit(const protocol::Registration& registration) const;
    [[nodiscard]] bool has(const Link& link, std::uint16_t channel) const { return ids_.contains({&link, channel}); }
    /// How many registrations of this peer there are.
    [[nodiscard]] std::size_t receivers(const Link& link) const;
    /// One that fits, on a channel that is free.
    void add(const LinkPtr& link, std::uint16_t channel, const protocol::Registration& registration);
    void request(const Link& link, std::uint16_t channel, const protocol::Request& request);
    /// @return false when there is no such receiver
    bool remove(const Link& link, std::uint16_t channel);
    void link_closed(const Link& link);
    void offer(EmissionPtr event, bool hold);
    void tick();

    [[nodiscard]] bool wanted() const noexcept { return wanted_.load(std::memory_order_relaxed); }
    [[nodiscard]] bool asked() const noexcept { return asked_.load(std::memory_order_relaxed); }
    [[nodiscard]] bool backlogged() const noexcept { return backlogged_; }
    [[nodiscard]] bool leasing() const { return table_.leasing(); }
    /// As in `status` (SPEC.md, section 6.4).
    /// @param most_receivers  rows to list at most; counts them down, and says how many are left out
    [[nodiscard]] Json status(std::size_t& most_receivers) const;

private:
    using Key = std::pair<const Link*, std::uint16_t>;
    struct Place {
        LinkPtr link;
        std::uint16_t channel;
    };
    void execute(const ReceiverTable::Decisions& decisions);
    void forget(std::map<Key, ReceiverTable::Id>::iterator place, bool left);
    void refresh();

    Port port_;
    protocol::PacketType carrier_;
    std::function<void()> on_change_;
    std::function<void(const EmissionPtr&)> on_failed_;
    ReceiverTable table_;
    std::map<Key, ReceiverTable::Id> ids_;
    std::map<ReceiverTable::Id, Place> places_;
    ReceiverTable::Id next_id_ = 0;
    std::int64_t produced_ = 0;
    std::int64_t last_emitted_us_ = 0;
    std::atomic<bool> wanted_ = false, asked_ = false;
    bool backlogged_ = false;
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace hive::event
