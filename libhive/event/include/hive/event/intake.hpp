// An input's connection to one output of another module: registers, asks, acknowledges, and comes back after a loss.
#pragma once

#include <hive/backoff.hpp>
#include <hive/event/link.hpp>
#include <hive/event.hpp>
#include <hive/transport/transport.hpp>

#include <asio/steady_timer.hpp>

#include <atomic>
#include <functional>
#include <memory>
#include <set>
#include <string>

namespace hive::event {

class Module;

struct IntakeSpec {
    std::string sender;  ///< the drone
    std::string output;
    transport::Address address;  ///< where it is met
    std::string input;           ///< of this module
    std::string receiver;        ///< this end as the sender knows it: "face.image"
    std::string accepts = "*/*";
    bool stateful = false;
    ConnectionOptions options;
};

/// Network side, but for the counters and for receipts, which may be dropped on any thread.
class Intake : public std::enable_shared_from_this<Intake> {
public:
    using Sink = std::function<void(Event&&)>;

    Intake(Module& module, IntakeSpec spec, Sink sink);

    /// Dials and registers. `first` hears how the first attempt went; later losses are repaired without a word.
    void start(OnOutcome first);
    /// Deregisters; no event comes after this. `left` is called when the sender has confirmed, or cannot.
    void stop(std::function<void()> left = [] {});
    /// Asks for what may be asked for now.
    void flush();
    void link_closed(const Link& link);

    [[nodiscard]] const IntakeSpec& spec() const noexcept { return spec_; }
    [[nodiscard]] bool connected() const noexcept { return connected_; }
    [[nodiscard]] Json status() const;
    std::atomic<std::int64_t> lost{0};  ///< events that this end dropped because its queue was full

private:
    void attempt();
    void registered(const LinkPtr& link, const Outcome& outcome);
    void failed(const Error& error);
    void retry();
    void on_packet(const protocol::Packet& packet);
    void finished(std::int64_t epoch, std::int64_t number);
    [[nodiscard]] std::shared_ptr<const void> receipt(std::int64_t number);
    [[nodiscard]] std::int64_t done() const;

    Module& module_;
    IntakeSpec spec_;
    Sink sink_;
    OnOutcome first_;
    Backoff backoff_;
    asio::steady_timer timer_;
    LinkPtr link_;
    std::uint16_t channel_ = 0;
    bool connected_ = false, stopped_ = false;
    std::string error_;
    std::int64_t epoch_ = 0;
    // of the present registration
    std::int64_t arrived_ = 0, finished_ = 0, asked_ = 0, acknowledged_ = 0;
    std::set<std::int64_t> outstanding_;
    // of all
    std::int64_t received_ = 0, processed_ = 0, age_us_ = 0;
};

}  // namespace hive::event
