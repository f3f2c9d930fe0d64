// The common part of drones and applications: links to peers, outlets, intakes, requests, and the loop that runs them.
#pragma once

#include <hive/event/encoder_thread.hpp>
#include <hive/event/end_check.hpp>
#include <hive/event/home.hpp>
#include <hive/event/intake.hpp>
#include <hive/event/link.hpp>
#include <hive/event/loop.hpp>
#include <hive/event/mailbox.hpp>
#include <hive/event/outlet.hpp>
#include <hive/event/rate_limits.hpp>
#include <hive/log_level.hpp>
#include <hive/platform/signals.hpp>
#include <hive/platform/timer.hpp>

#include <algorithm>
#include <atomic>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

namespace hive::event {

/// A request of a peer, to be answered exactly once, from any thread. Without an answer it expires at its deadline.
struct Incoming {
    std::string peer;
    std::int64_t peer_epoch = 0;
    Role role = Role::viewer;  ///< of the peer
    std::string peer_place;    ///< the peer's address: "pid 4711", "192.0.2.7:50012"
    Json header;
    Body body;
    std::shared_ptr<Asked> asked;  ///< to be taken up by code that must not act after the deadline
    OnOutcome answer;
    const void* connection = nullptr;  ///< identifies the connection of the request, as long as it lasts
    std::function<bool()> connected;   ///< network side: is that connection still open?
};

/// Functions are for the network side (the thread that has the turn of the loop) unless they say otherwise.
class Module {
public:
    struct Options {
        protocol::Hello self;
        protocol::Limits limits;
        transport::Timing timing;
        std::shared_ptr<transport::KeyRing> keys = {};  ///< for tcp; null: unencrypted, and every peer is a member
        std::size_t most_dialed = 0;                    ///< above this number idle links are closed; 0: unlimited
        /// True if a process will listen at this address soon. Then a refused dial is repeated until its deadline.
        /// Needs most_dialing.
        std::function<bool(const transport::Address&)> listens_soon = {};
        std::size_t most_dialing = 0;  ///< maximum at once, except slow ones; others wait; 0: unlimited
        Log log = [](LogLevel, const std::string&) {};  ///< any thread
    };
    using RequestHandler = std::function<void(Incoming)>;
    using OnLink = std::function<void(const Result<LinkPtr>&)>;  ///< to a peer that has sent its hello

    explicit Module(Options options);
    virtual ~Module();  ///< calls end()
    Module(const Module&) = delete;
    Module& operator=(const Module&) = delete;

    // --- before start() ---
    Outlet& add_outlet(Port port, protocol::PacketType carrier = protocol::PacketType::event, Encoder encoder = {});
    void handle(protocol::PacketType type, RequestHandler handler) { handlers_[type] = std::move(handler); }
    std::function<void()> on_demand = [] {};       ///< the demand for an outlet changed
    std::function<void()> on_subscribers = [] {};  ///< subscribers() may have changed, and no peer was told yet
    std::function<void(const EmissionPtr&)> on_failed = [](const EmissionPtr&) {
    };  ///< a shared event is given up; its identity has the last attempt
    /// See Outlet::Hooks.
    std::function<void(const Outlet::Failing&)> on_failed_at = [](const Outlet::Failing&) {};
    /// For the text of an end; see Outlet::Hooks.
    std::function<std::string(const Event* newest)> failures = [](const Event*) { return std::string(); };
    /// An encoder threw; the event is sent unencoded.
    std::function<void(const EmissionPtr&, const Error&)> on_not_encoded = [](const EmissionPtr&, const Error&) {};
    /// Starts the network thread.
    void start();
    /// Deregisters everywhere and ends the network thread; any thread without the turn. Tasks posted later are dropped.
    void end();

    // --- any thread ---
    [[nodiscard]] Loop& loop() noexcept { return *loop_; }
    [[nodiscard]] std::weak_ptr<Loop> weak_loop() const { return loop_; }  ///< for code that may outlive the module
    void post(Loop::Task task) { loop_->post(std::move(task)); }
    void call(const Loop::Task& task) { loop_->call(task); }
    /// The next item of a mailbox that the network side fills (while halted only commands); runs the network side until
    /// there is one. Nothing when the deadline has passed or the mailbox was nudged. For one thread.
    std::optional<Mailbox::Item> next(Mailbox& mailbox, Clock::time_point deadline);
    /// Total time spent encoding events for receivers.
    [[nodiscard]] std::chrono::nanoseconds encoding() const { return encoder_thread_.worked(); }
    /// Runs a task on the encoder thread that would block the network side, such as writing a large file; drops it if
    /// the module ends first.
    void do_aside(EncoderThread::Job job) { encoder_thread_.push("", std::move(job)); }
    /// The pool for bodies that peers on this machine read without a copy.
    [[nodiscard]] transport::Pool& pool() const noexcept { return *pool_; }
    [[nodiscard]] const protocol::Hello& self() const noexcept { return options_.self; }
    void log(LogLevel level, const std::string& text) const { options_.log(level, text); }
    /// Logs a line that a peer causes, at a limited rate, since the peer could repeat it.
    void log_about(LogLevel level, const std::string& peer, const std::string& text);
    /// While halted, intakes request nothing and mailboxes return only commands.
    void halt(bool halted);
    /// The user thread, at the end: waits briefly until emitted events are acknowledged.
    void settle();
    /// Calls back on the network side when the process gets SIGINT or SIGTERM.
    void on_signal(std::function<void(int)> handler);

    // --- network side ---
    /// A timer with a pending task must be destroyed before the module ends, which would wait for it.
    [[nodiscard]] asio::io_context& context() { return loop_->context(); }
    transport::Address listen(const transport::Address& address);
    /// Returns a link to the module at an address: the existing one, or a new one. The error counts only without link.
    void with_link(const transport::Address& address, Clock::time_point deadline, OnLink on_link);
    void request(const transport::Address& address, protocol::PacketType type, Json header, Body body,
                 Clock::time_point deadline, OnOutcome on_outcome);
    /// @param on_end  called when the result of EndOfInputs may have changed
    std::shared_ptr<Intake> add_intake(
        IntakeSpec spec, Intake::Sink sink, std::function<void()> on_end = [] {});
    void remove_intake(
        const std::shared_ptr<Intake>& intake, std::function<void()> left = [] {});
    /// Leaves the inputs to the process that takes over: their senders get the acknowledgements, and no end.
    void hand_over();
    [[nodiscard]] const std::vector<std::shared_ptr<Intake>>& intakes() const noexcept { return intakes_; }
    /// Removed intakes that have not finished all their events.
    [[nodiscard]] const std::vector<std::shared_ptr<Intake>>& leaving() const noexcept { return leaving_; }
    /// An event from a `put` into an input: counted, and passed to the sink.
    void accept(Event event, const Intake::Sink& sink);
    /// Counters of events from `put` or from removed intakes; one row per input.
    [[nodiscard]] std::vector<InputStatus> left() const;
    /// The receivers for which the sources of this module wait, including expected ones.
    [[nodiscard]] std::vector<Subscriber> subscribers() const;
    void expect(const std::vector<Subscriber>& subscribers, std::optional<Clock::time_point> until);
    /// As Outlet::forget. @param output  empty: every output
    std::size_t forget(const std::string& drone, const std::string& output);
    [[nodiscard]] std::list<Outlet>& outlets() noexcept { return outlets_; }
    /// Calls back once the senders that sent an end have answered whether it still holds, and the answer was passed on.
    void make_sure(std::chrono::milliseconds within, EndCheck::Then then);
    /// An intake may have had such an answer.
    void look_at_ends() { end_check_.look(); }
    /// Offers an event; lossless ones, except exceptions, wait for a receiver when this module has none at all.
    void emit(Outlet& outlet, EmissionPtr event);
    /// Do results wait here for their first receiver? Not at the end of this module.
    [[nodiscard]] bool holds() const { return !ending_ && std::ranges::any_of(outlets_, &Outlet::holds); }
    /// Must intakes request nothing: halted, or lossless events wait for a receiver?
    [[nodiscard]] Reason paused() const
    {
        return halted_ ? Reason::halted : backlogged_ ? Reason::backlog : Reason::none;
    }
    /// The epoch of a new registration: later than that of any earlier one, of any input.
    std::int64_t next_registration() { return registration_ = std::max(registration_ + 1, wall_us()); }
    /// A deadline may have been added: ticks as long as there is one.
    void arm();
    /// A removed intake has left its sender and finished all its events.
    void gone(const std::shared_ptr<Intake>& intake);

private:
    struct Waiting {  ///< a caller that waits for a link
        Clock::time_point deadline;
        OnLink on_link;
    };
    void release_held();
    void await_earlier_run(const LinkPtr& link);
    void await_end_or_answer(Link& earlier, const LinkPtr& link);
    void let_one_go();
    void dial_next();
    void dial(const transport::Address& address, const std::string& key, Clock::time_point deadline);
    LinkPtr make_link(std::shared_ptr<transport::Connection> connection, Link::End end);
    [[nodiscard]] transport::Security security();
    void watch_keys();
    void recheck_keys();
    void adopt(const LinkPtr& link, OnLink ready);
    void dialed(const std::string& key, const Result<LinkPtr>& link);
    void last_one_gone();
    /// Those that are leaving, too.
    [[nodiscard]] std::vector<std::shared_ptr<Intake>> all_intakes() const;
    void on_packet(Link& link, const protocol::Packet& packet);
    bool make_room(Role newcomer, const std::function<bool(const Link&)>& may_go);
    [[nodiscard]] std::size_t peers(bool (*like)(const Link&)) const;
    bool has_local_place();
    bool has_place(const Link& newcomer);
    void turn_away(const transport::Connection& connection);
    void on_register(Link& link, const protocol::Packet& packet, const Json& header);
    [[nodiscard]] Json confirmation(const Outlet& sender, const Welcome& welcome) const;
    void require_free(const Link& link, std::uint16_t channel) const;
    void on_deregister(Link& link, const protocol::Packet& packet, const Json& header);
    void on_request_packet(Link& link, const protocol::Packet& packet, Json header);
    OnOutcome answer_to(Link& link, const std::shared_ptr<Asked>& asked);
    void expire_asked(Link& link, Clock::time_point now);
    void come_through_the_socket(const std::string& peer);
    void on_closed(Link& link, const Error& reason);
    void log_end(Link& link, const Error& reason, Fate fate);
    void demand_changed();
    void tick();
    void expire_dialing(Clock::time_point now);
    void leave();
    void close_links();
    Outlet& outlet(const std::string& name);

    Options options_;
    std::shared_ptr<transport::Pool> pool_ = std::make_shared<transport::Pool>();
    std::shared_ptr<Loop> loop_ = std::make_shared<Loop>();
    platform::Timer timer_{context()};
    platform::Timer last_{context()};
    platform::Timer keys_timer_{context()};
    bool watching_keys_ = false;
    std::string keys_error_;  ///< the last logged error of the key file
    RateLimits refusals_{10, std::chrono::seconds(10)};
    RateLimits arrivals_{1024, std::chrono::seconds(1)};
    RateLimits registrations_{4096, std::chrono::seconds(10)};
    std::optional<platform::Signals> signals_;
    bool armed_ = false, ending_ = false, handed_over_ = false;
    RateLimits lines_{10, std::chrono::seconds(1)};
    std::set<std::string> unmappable_;  ///< peers whose shared memory could not be mapped, by identity
    std::atomic<bool> halted_ = false;
    bool backlogged_ = false;
    std::int64_t registration_ = 0;
    std::list<Outlet> outlets_;
    std::vector<std::shared_ptr<Intake>> intakes_;
    EndCheck end_check_{context(), intakes_};
    std::vector<std::shared_ptr<Intake>> leaving_;
    std::map<std::string, InputStatus> left_;              ///< by input
    std::map<std::string, std::shared_ptr<Intake>> puts_;  ///< by input: unconnected; they count the events of `put`
    std::map<protocol::PacketType, RequestHandler> handlers_;
    std::vector<std::unique_ptr<transport::Listener>> listeners_;
    std::vector<LinkPtr> links_;                     ///< in the order of their arrival
    std::multimap<std::string, LinkPtr> of_drones_;  ///< those after their hello, by the drone's name
    std::map<std::string, LinkPtr> dialed_;
    std::map<std::string, std::vector<Waiting>> dialing_;  ///< in progress, or still to be started
    std::map<std::string, Clock::time_point> under_way_;   ///< start of each dial, if their number is limited
    std::deque<transport::Address> to_dial_;
    std::vector<transport::Address> refused_;  ///< to be dialed again
    EncoderThread encoder_thread_;
};

}  // namespace hive::event
