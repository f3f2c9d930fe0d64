// The lifetime of a module, its parts and its timer.
#include <hive/event/module.hpp>
#include <hive/protocol/defended.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace hive::event {

using protocol::PacketType;

namespace {

constexpr auto tick_period = std::chrono::milliseconds(20);
constexpr auto shutdown_timeout = std::chrono::milliseconds(300);
constexpr std::size_t most_peers = 256;
const std::size_t most_viewers = defended("share-of-viewers") ? 64 : most_peers;  ///< of them

/// In addition to these, for the local socket, and as many for remote applications.
const std::size_t reserved = defended("reserved-places") ? 32 : 0;

}  // namespace

Module::Module(Options options) : options_(std::move(options))
{
    loop_->on_thrown = [this](const std::string& what) {
        log_about(LogLevel::error, "", "the network side threw: " + what);
    };
}

Module::~Module() { end(); }

void Module::end()
{
    encoder_thread_.end();
    if (loop_->started()) {
        leave();
        call([this] { close_links(); });
        loop_->end();
    }
    pool_->end();
}

/// Deregisters everywhere and waits briefly for the confirmations, so that no peer treats the end as a loss.
void Module::leave()
{
    call([&] {
        ending_ = true;
        listeners_.clear();
        for (const auto& intake : std::vector(intakes_))
            remove_intake(intake);
    });
    const auto left = [&] {
        return std::ranges::all_of(leaving_, [](const auto& intake) { return intake->has_left(); });
    };
    loop_->wait(Clock::now() + shutdown_timeout, left);
    call([&] {
        for (const auto& intake : std::vector(leaving_))
            intake->leave_now();
    });
    loop_->wait(Clock::now() + shutdown_timeout, left);
}

void Module::close_links()
{
    signals_.reset();
    keys_timer_.cancel();
    end_check_.stop();
    armed_ = false;
    timer_.cancel();  // a tick that is due in 20 ms would delay the end of a command by that time
    if (!handed_over_)
        for (auto& outlet : outlets_)
            outlet.say_leaving();
    for (const auto& link : std::vector(links_))
        link->close(Error(Errc::stopped, options_.self.name + " is ending"));
    if (options_.most_dialing > 0)
        std::erase_if(dialing_, [this](const auto& row) { return !under_way_.contains(row.first); });
    if (links_.empty() && dialing_.empty())
        return;
    // Only closings and dials in progress are left: do not wait for a peer that does not answer.
    last_.run_after(shutdown_timeout, [this] { context().stop(); });
}

void Module::on_signal(std::function<void(int)> handler) { signals_.emplace(context(), std::move(handler)); }

void Module::start() { loop_->start(); }

std::optional<Mailbox::Item> Module::next(Mailbox& mailbox, Clock::time_point deadline)
{
    const auto ready = [&] { return mailbox.ready(!halted_); };
    if (ready())
        loop_->serve();  // the last item's ticket and emissions must not wait
    else
        loop_->wait(deadline, ready);
    return mailbox.pop(!halted_);
}

void Module::halt(bool halted)
{
    halted_ = halted;
    post([this] {
        for (const auto& intake : intakes_)
            intake->flush();
    });
}

void Module::settle()
{
    loop_->serve();
    loop_->wait(Clock::now() + shutdown_timeout, [this] {
        return std::ranges::none_of(all_intakes(), [](const auto& intake) { return intake->owes(); });
    });
}

void Module::hand_over()
{
    handed_over_ = true;
    for (const auto& intake : all_intakes())
        intake->hand_over();
    intakes_.clear();
}

std::vector<std::shared_ptr<Intake>> Module::all_intakes() const
{
    auto all = intakes_;
    all.insert(all.end(), leaving_.begin(), leaving_.end());
    return all;
}

Outlet& Module::add_outlet(Port port, PacketType carrier, Encoder encoder)
{
    if (encoder.encode)
        encoder.encode = [pool = pool_, encode = std::move(encoder.encode)](const Event& event,
                                                                            const std::string& encoding) {
            Event encoded = encode(event, encoding);
            encoded.body = pool->copied_in(encoded.body);
            return encoded;
        };
    Outlet::Hooks hooks{
        .changed = [this] { demand_changed(); },
        .failed = [this](const EmissionPtr& event) { on_failed(event); },
        .failed_at = [this](const Outlet::Failing& failing) { on_failed_at(failing); },
        .failures = [this](const Event* newest) { return failures(newest); },
        .make_sure = [this](auto within, auto then) { make_sure(within, std::move(then)); },
        .not_encoded = [this](const EmissionPtr& event, const Error& problem) { on_not_encoded(event, problem); },
        .on_encoder_thread = [this](const std::string& peer,
                                    std::function<void()> job) { encoder_thread_.push(peer, std::move(job)); },
        .on_network_side = [this](std::function<void()> task) { post(std::move(task)); }};
    return outlets_.emplace_back(options_.self, std::move(port), carrier, std::move(encoder), std::move(hooks));
}

transport::Address Module::listen(const transport::Address& address)
{
    listeners_.push_back(transport::listen(
        context(), address,
        [this](std::shared_ptr<transport::Connection> connection) {
            if (const auto& place = connection->peer(); !arrivals_.pass(without_port(place), Clock::now()))
                return log_about(LogLevel::warning, place,
                                 "refused " + place + ": more than 1024 connections within 1 s");
            const bool local = connection->credentials().role == Role::owner;
            if (local && !has_local_place())
                return turn_away(*connection);
            adopt(make_link(std::move(connection), Link::End::accepted), [this, local](const Result<LinkPtr>& opened) {
                if (const auto link = value_or_none(opened); link && !local && !has_place(*link)) {
                    turn_away(link->connection());
                    std::erase(links_, link);  // at once, so that it takes no place until its end is reported
                    link->close(Error(Errc::refused, "too many peers"));
                }
            });
        },
        options_.timing, security()));
    return listeners_.back()->address();
}

namespace {

bool is_local(const Link& link) { return link.credentials().role == Role::owner; }
/// Peers after their hello; the transport bounds the others.
bool is_remote(const Link& link) { return !is_local(link) && link.open(); }
bool is_viewer(const Link& link) { return is_remote(link) && link.credentials().role == Role::viewer; }
bool is_remote_application(const Link& link) { return is_remote(link) && link.peer().kind == "application"; }

}  // namespace

std::size_t Module::peers(bool (*like)(const Link&)) const
{
    return static_cast<std::size_t>(std::ranges::count_if(links_, [&](const LinkPtr& link) { return like(*link); }));
}

/// May one more peer connect through the local socket? Called before its hello.
bool Module::has_local_place()
{
    return links_.size() < most_peers || peers(is_local) < reserved
           || make_room(Role::owner, [](const Link&) { return true; });
}

/// May a remote peer stay after its hello? Some places are reserved for applications, so that an operator can connect
/// to a full drone, and is not evicted for its regular peers. Viewers have a share of the places, so that they keep no
/// member out.
bool Module::has_place(const Link& newcomer)
{
    const auto role = newcomer.credentials().role;
    const auto other_viewer = [&](const Link& link) { return &link != &newcomer && is_viewer(link); };
    if (is_viewer(newcomer) && peers(is_viewer) > most_viewers && !make_room(role, other_viewer))
        return false;
    const auto applications = peers(is_remote_application);
    if (peers(is_remote) - std::min(applications, reserved) <= most_peers)
        return true;
    return make_room(role, [&](const Link& link) {
        return &link != &newcomer && is_remote(link) && (applications > reserved || !is_remote_application(link));
    });
}

void Module::turn_away(const transport::Connection& connection)
{
    const bool viewer = connection.credentials().role == Role::viewer;
    security().refused(
        "refused " + connection.peer() + ": "
        + (viewer ? std::to_string(most_viewers) + " viewers are" : std::to_string(most_peers) + " peers are")
        + " connected, and each has something to do here");
}

/// Evicts the peer without registrations and requests in progress that has been idle for longest, viewers first, so
/// that idle peers keep no active one out. If there is none, evicts a viewer for a member.
bool Module::make_room(Role newcomer, const std::function<bool(const Link&)>& may_go)
{
    enum Rank { idle_viewer, idle_member, busy_viewer, stays };
    const auto rank = [&](const Link& link) {
        const auto receives = [&link](const Outlet& outlet) { return outlet.receivers(link) > 0; };
        const bool viewer = link.credentials().role == Role::viewer;
        if (link.idle() && std::ranges::none_of(outlets_, receives))
            return viewer ? idle_viewer : idle_member;
        return viewer && newcomer != Role::viewer ? busy_viewer : stays;
    };
    LinkPtr first;
    auto chosen = std::pair(stays, Clock::time_point());
    for (const auto& link : links_)
        if (const auto order = std::pair(rank(*link), link->used());
            order.first != stays && may_go(*link) && (!first || order < chosen)) {
            first = link;
            chosen = order;
        }
    if (!first)
        return false;
    std::erase(links_, first);  // at once, so that it is not chosen again before its end is reported
    first->close(Error(Errc::refused, chosen.first == busy_viewer
                                          ? "a member needed the place of a viewer"
                                          : "it had nothing to do here, and another peer needed the place"));
    return true;
}

std::shared_ptr<Intake> Module::add_intake(IntakeSpec spec, Intake::Sink sink, std::function<void()> on_end)
{
    return intakes_.emplace_back(std::make_shared<Intake>(*this, std::move(spec), std::move(sink), std::move(on_end)));
}

void Module::remove_intake(const std::shared_ptr<Intake>& intake, std::function<void()> left)
{
    const auto keep = intake;
    std::erase(intakes_, intake);
    leaving_.push_back(keep);
    keep->stop(std::move(left));
}

void Module::make_sure(std::chrono::milliseconds within, EndCheck::Then then)
{
    if (!defended("end-question"))
        return then();
    end_check_.begin(within, std::move(then));
}

namespace {

void add_counts(InputStatus& sum, const InputStatus& more)
{
    sum.input = more.input;
    for (const auto count :
         {&InputStatus::received, &InputStatus::processed, &InputStatus::abandoned, &InputStatus::duplicates,
          &InputStatus::discarded, &InputStatus::dropped, &InputStatus::unmatched, &InputStatus::in_hand})
        sum.*count += more.*count;
    sum.last_lost_us = std::max(sum.last_lost_us, more.last_lost_us);
    if (!more.kind.empty())
        sum.kind = more.kind;
}

}  // namespace

void Module::gone(const std::shared_ptr<Intake>& intake)
{
    if (std::erase(leaving_, intake) > 0)
        add_counts(left_[intake->spec().input], intake->status());
}

std::vector<InputStatus> Module::left() const
{
    auto sums = left_;
    for (const auto& intake : leaving_)
        add_counts(sums[intake->spec().input], intake->status());
    for (const auto& [input, intake] : puts_)
        add_counts(sums[input], intake->status());
    std::vector<InputStatus> rows;
    for (const auto& [input, sum] : sums)
        rows.push_back(sum);
    return rows;
}

void Module::accept(Event event, const Intake::Sink& sink)
{
    auto& intake = puts_[event.input];
    if (!intake)
        intake = std::make_shared<Intake>(*this, IntakeSpec{.input = event.input}, sink);
    intake->accept(std::move(event));
}

std::vector<Subscriber> Module::subscribers() const
{
    std::vector<Subscriber> all;
    for (const auto& outlet : outlets_)
        std::ranges::move(outlet.subscribers(), std::back_inserter(all));
    return all;
}

/// Skips subscribers of an output that this drone no longer has.
void Module::expect(const std::vector<Subscriber>& subscribers, std::optional<Clock::time_point> until)
{
    for (const auto& subscriber : subscribers)
        for (auto& outlet : outlets_)
            if (outlet.port().name == subscriber.output)
                outlet.expect(subscriber, until);
    arm();
}

std::size_t Module::forget(const std::string& drone, const std::string& output)
{
    std::size_t forgotten = 0;
    for (auto& outlet : outlets_)
        if (output.empty() || outlet.port().name == output)
            forgotten += outlet.forget(drone);
    on_subscribers();
    return forgotten;
}

void Module::emit(Outlet& outlet, EmissionPtr event)
{
    const auto gives_events = [](const Outlet& each) { return each.carrier() == PacketType::event; };
    const bool nobody =
        std::ranges::none_of(outlets_, [&](const Outlet& each) { return gives_events(each) && each.awaited(); });
    // An exception goes to present receivers only.
    outlet.offer(event, gives_events(outlet) && nobody);
    arm();
}

/// Drops held events once another output of this module has a receiver.
void Module::release_held()
{
    const auto awaited = [](const Outlet& each) { return each.carrier() == PacketType::event && each.awaited(); };
    if (std::ranges::any_of(outlets_, awaited))
        for (auto& outlet : outlets_)
            if (!outlet.awaited())
                outlet.release_held();
}

void Module::demand_changed()
{
    const bool before = std::exchange(backlogged_, std::ranges::any_of(outlets_, &Outlet::backlogged));
    if (before && !backlogged_)
        for (const auto& intake : intakes_)
            intake->flush();
    on_demand();
}

void Module::arm()
{
    if (armed_)
        return;
    const bool needed = !dialing_.empty()
                        || std::ranges::any_of(links_, [](const LinkPtr& link) { return link->pending(); })
                        || (!ending_ && std::ranges::any_of(outlets_, &Outlet::timed));
    if (!needed)
        return;
    armed_ = true;
    timer_.run_after(tick_period, [this] {
        armed_ = false;
        tick();
    });
}

void Module::tick()
{
    const auto now = Clock::now();
    for (const auto& link : std::vector(links_)) {
        link->expire(now);
        expire_asked(*link, now);
    }
    expire_dialing(now);
    std::ranges::move(std::exchange(refused_, {}), std::back_inserter(to_dial_));
    dial_next();
    for (auto& outlet : outlets_)
        if (outlet.timed())
            outlet.tick();
    on_subscribers();
    arm();
}

}  // namespace hive::event
