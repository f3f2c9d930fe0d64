// The links of a module: opens, shares and closes them, also when their key becomes invalid.
#include <hive/event/module.hpp>
#include <hive/platform/process.hpp>

#include <algorithm>
#include <iterator>

namespace hive::event {

using protocol::PacketType;

namespace {

/// A successful dial has done nearly all its work by then.
constexpr auto busy_dialing = std::chrono::milliseconds(250);
constexpr auto look_at_keys_every = std::chrono::milliseconds(1000);

}  // namespace

LinkPtr Module::make_link(std::shared_ptr<transport::Connection> connection, Link::End end)
{
    if (!connection->credentials().key.empty())
        watch_keys();
    const bool maps = !unmappable_.contains(connection->peer());
    return std::make_shared<Link>(std::move(connection), end, options_.self, options_.limits, pool_, maps);
}

void Module::adopt(const LinkPtr& link, OnLink ready)
{
    links_.push_back(link);
    const auto told = std::make_shared<bool>(false);
    link->start({.opened =
                     [this, ready, told](Link& opened) {
                         *told = true;
                         const auto keep = opened.shared_from_this();
                         const auto& place = opened.connection().peer();
                         log_about(LogLevel::debug, place, "opened link to " + opened.peer().name + " at " + place);
                         await_earlier_run(keep);
                         ready(keep);
                     },
                 .packet = [this](Link& from, const protocol::Packet& packet) { on_packet(from, packet); },
                 .closed =
                     [this, ready, told](Link& closed, const Error& reason) {
                         const auto keep = closed.shared_from_this();
                         on_closed(closed, reason);
                         if (!*told)
                             ready(reason);
                     }});
}

void Module::with_link(const transport::Address& address, Clock::time_point deadline, OnLink on_link)
{
    const auto key = to_text(address);
    if (const auto found = dialed_.find(key); found != dialed_.end())
        return on_link(found->second);
    auto& waiting = dialing_[key];
    waiting.push_back({deadline, std::move(on_link)});
    arm();
    if (waiting.size() > 1)
        return;
    if (options_.most_dialing == 0)
        return dial(address, key, deadline);
    to_dial_.push_back(address);
    dial_next();
}

/// Few at a time, since a peer does not wait long for the hello of a new connection. A slow dial costs nothing
/// meanwhile and does not count, so that unreachable peers do not delay others.
void Module::dial_next()
{
    const auto now = Clock::now();
    auto busy = static_cast<std::size_t>(
        std::ranges::count_if(under_way_, [now](const auto& row) { return now - row.second < busy_dialing; }));
    while (!to_dial_.empty() && busy < options_.most_dialing) {
        const auto address = to_dial_.front();
        to_dial_.pop_front();
        const auto key = to_text(address);
        const auto row = dialing_.find(key);
        if (row == dialing_.end() || !under_way_.try_emplace(key, now).second)
            continue;  // no caller waits any more, or a dial for an earlier caller is still in progress
        ++busy;
        dial(address, key, row->second.front().deadline);
    }
}

void Module::dial(const transport::Address& address, const std::string& key, Clock::time_point deadline)
{
    if (options_.most_dialed > 0 && dialed_.size() + std::max<std::size_t>(under_way_.size(), 1) > options_.most_dialed)
        let_one_go();
    const auto timeout = std::max(std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()),
                                  std::chrono::milliseconds(1));
    transport::dial(
        context(), address, timeout,
        [this, address, key](Result<std::shared_ptr<transport::Connection>> connection) {
            if (const auto* error = error_of(connection)) {
                const bool again = !ending_ && error->code() == Errc::unreachable && options_.listens_soon
                                   && options_.listens_soon(address);
                if (!again)
                    return dialed(key, *error);
                under_way_.erase(key);
                refused_.push_back(address);
                return dial_next();
            }
            if (ending_)
                return dialed(key, Error(Errc::stopped, options_.self.name + " is ending"));
            adopt(make_link(value_or_none(std::move(connection)), Link::End::dialed),
                  [this, key](const Result<LinkPtr>& link) { dialed(key, link); });
        },
        options_.timing, security());
}

/// Closes the most recently used link: a caller that queries many drones in rounds needs that one last.
void Module::let_one_go()
{
    auto latest = dialed_.end();
    for (auto it = dialed_.begin(); it != dialed_.end(); ++it)
        if (it->second->idle() && (latest == dialed_.end() || it->second->used() > latest->second->used()))
            latest = it;
    if (latest == dialed_.end())
        return;
    const auto link = latest->second;
    dialed_.erase(latest);  // at once, so that no request uses it any more
    link->close(Error(Errc::stopped, options_.self.name + " closed an idle connection"));
}

void Module::dialed(const std::string& key, const Result<LinkPtr>& link)
{
    under_way_.erase(key);
    auto node = dialing_.extract(key);
    if (!error_of(link))
        dialed_[key] = std::get<LinkPtr>(link);
    if (!node.empty())
        for (const auto& waiting : node.mapped())
            waiting.on_link(link);
    dial_next();
    last_one_gone();
}

/// Ends the final wait once there are neither links nor dials in progress.
void Module::last_one_gone()
{
    if (ending_ && links_.empty() && dialing_.empty())
        last_.cancel();
}

void Module::request(const transport::Address& address, PacketType type, Json header, Body body,
                     Clock::time_point deadline, OnOutcome on_outcome)
{
    with_link(address, deadline,
              [this, type, header = std::move(header), body = std::move(body), deadline,
               on_outcome = std::move(on_outcome)](const Result<LinkPtr>& link) {
                  if (const auto* error = error_of(link))
                      return on_outcome(*error);
                  std::get<LinkPtr>(link)->request(type, header, body, deadline, on_outcome);
                  arm();
              });
}

/// A hello with the name of a connected drone and a larger epoch comes from its next run, perhaps as another kind, or
/// from another drone of that name. The connection of an earlier run ends by itself, at the latest after the inactivity
/// timeout; another drone answers a ping. Requests of the new drone wait for either. Names of applications are not
/// unique, and those of viewers are not trusted.
void Module::await_earlier_run(const LinkPtr& link)
{
    const auto& peer = link->peer();
    if (peer.kind == "application")
        return;
    const auto [begin, end] = of_drones_.equal_range(peer.name);
    std::vector<LinkPtr> earlier;
    for (auto row = begin; row != end; ++row)
        if (const auto& other = row->second; other->open() && other->peer().epoch < peer.epoch)
            earlier.push_back(other);
    of_drones_.emplace(peer.name, link);
    if (link->credentials().role != Role::viewer)
        for (const auto& other : earlier)
            await_end_or_answer(*other, link);
}

/// Time in which this end is suspended does not count: what arrived meanwhile may still be unread.
static void after_awake(const std::shared_ptr<platform::Timer>& timer, Clock::duration step, Clock::duration time,
                        std::function<void()> then)
{
    timer->run_after(step, [timer, step, left = time - step, then = std::move(then)] {
        left > Clock::duration::zero() ? after_awake(timer, step, left, then) : then();
    });
}

void Module::await_end_or_answer(Link& earlier, const LinkPtr& link)
{
    link->defer();
    const auto timer = std::make_shared<platform::Timer>(context());
    const auto go_on = [this, timer, decided = std::make_shared<bool>(false), weak = std::weak_ptr(link),
                        place = earlier.connection().peer()](bool lives) {
        const auto to = weak.lock();
        if (std::exchange(*decided, true))
            return;
        timer->cancel();
        if (!to)
            return;
        if (lives)
            log_about(LogLevel::warning, place,
                      "two drones are called " + to->peer().name + ", one at " + place + " and one at "
                          + to->connection().peer() + "; give one of them another name");
        to->go_on();
        arm();
    };
    // Any packet shows that it is alive, not only a pong; otherwise it has been disconnected by then.
    const auto& timing = options_.timing;
    after_awake(timer, timing.heartbeat, timing.silence + timing.heartbeat, [go_on] { go_on(true); });
    earlier.connection().ping(go_on);
}

namespace {

/// The outcome of a peer's events in progress when its connection ends.
Fate fate_by(Link& link, const Error& reason)
{
    if (!link.connection().ended_by_peer())
        return reason.code() == Errc::stopped ? Fate::lost_connection : Fate::lost_cut_off;
    // The peer may have disconnected this end.
    const bool died = link.local() ? platform::process_ends(link.peer().pid) : !link.connection().seemed_dead();
    return died ? Fate::lost_killed : Fate::lost_connection;
}

std::string without_prefix(std::string_view text, std::string_view prefix)
{
    return std::string(text.substr(text.starts_with(prefix) ? prefix.size() : 0));
}

}  // namespace

/// Lines of different levels are limited separately.
void Module::log_about(LogLevel level, const std::string& peer, const std::string& text)
{
    if (const auto left_out = lines_.pass(std::string(token(level)) + " " + without_port(peer), Clock::now()))
        log(level, text + left_out_text(*left_out));
}

/// A leaving receiver deregisters first, and a replaced one closes its connection and keeps running.
void Module::log_end(Link& link, const Error& reason, Fate fate)
{
    const auto& place = link.connection().peer();
    const auto text = ": " + without_prefix(reason.what(), place + ": ");
    const auto code = reason.code();
    if (code == Errc::malformed || code == Errc::too_large || code == Errc::version_mismatch || code == Errc::io
        || code == Errc::not_permitted)
        return log_about(LogLevel::warning, place, "closed " + place + text);
    const auto name = link.peer().name.empty() ? place : link.peer().name + " at " + place;
    const auto receives = [&](const Outlet& outlet) { return outlet.receivers(link) > 0; };
    if (fate != Fate::lost_connection && std::ranges::any_of(outlets_, receives))
        return log_about(LogLevel::warning, place, "lost receiver " + name + text);
    log_about(LogLevel::debug, place, "closed link to " + name + text);
}

/// This peer's shared memory could not be mapped: its next connection does without. The other peers keep sharing.
void Module::come_through_the_socket(const std::string& peer)
{
    constexpr std::size_t most_remembered = 256;
    if (unmappable_.size() >= most_remembered)
        unmappable_.erase(unmappable_.begin());
    unmappable_.insert(peer);
}

void Module::on_closed(Link& link, const Error& reason)
{
    if (reason.code() == Errc::io)
        come_through_the_socket(link.connection().peer());
    const auto fate = fate_by(link, reason);
    log_end(link, reason, fate);
    std::erase_if(dialed_, [&](const auto& row) { return row.second.get() == &link; });
    const auto [begin, end] = of_drones_.equal_range(link.peer().name);
    if (const auto row = std::find_if(begin, end, [&](const auto& each) { return each.second.get() == &link; });
        row != end)
        of_drones_.erase(row);
    std::erase(links_, link.shared_from_this());
    last_one_gone();
    for (auto& outlet : outlets_)
        outlet.link_closed(link, fate);
    on_subscribers();
    arm();
    for (const auto& intake : std::vector(intakes_))
        intake->link_closed(link);
}

/// A peer that accepts and sends nothing must not delay a caller beyond its deadline.
void Module::expire_dialing(Clock::time_point now)
{
    std::vector<Waiting> late;
    for (auto& [key, waiting] : dialing_)
        for (auto it = waiting.begin(); it != waiting.end();)
            if (it->deadline <= now) {
                late.push_back(std::move(*it));
                it = waiting.erase(it);
            } else {
                ++it;
            }
    std::erase_if(dialing_, [](const auto& row) { return row.second.empty(); });
    for (const auto& waiting : late)
        waiting.on_link(Error(Errc::timeout, "no answer in the time allowed"));
}

transport::Security Module::security()
{
    return {.keys = options_.keys, .refused = [this](const std::string& who) {
                if (const auto left_out = refusals_.pass("", Clock::now()))
                    log(LogLevel::warning, who + left_out_text(*left_out));
            }};
}

/// Checks once per second as long as a link depends on a key.
void Module::watch_keys()
{
    if (watching_keys_ || ending_)
        return;
    watching_keys_ = true;
    keys_timer_.run_after(look_at_keys_every, [this] {
        watching_keys_ = false;
        recheck_keys();
    });
}

void Module::recheck_keys()
{
    bool needed = false;
    for (const auto& link : std::vector(links_)) {
        const auto& [role, key] = link->credentials();
        if (key.empty())
            continue;
        needed = true;
        if (!options_.keys->accepts(key, role))
            link->close(Error(Errc::not_permitted, "the swarm key " + key + " has expired"));
        else if (role == Role::viewer && link->dialed() && !options_.keys->offers(key, role))
            link->close(Error(Errc::connection_lost, "a members' key has replaced the viewers' key " + key));
    }
    if (options_.keys && options_.keys->trouble() != keys_error_) {
        keys_error_ = options_.keys->trouble();
        if (!keys_error_.empty())
            log(LogLevel::warning, keys_error_ + "; the known keys stay valid");
    }
    if (needed)
        watch_keys();
}

}  // namespace hive::event
