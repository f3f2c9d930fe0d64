// The network thread and the dispatch of what peers send.
#include <hive/event/module.hpp>
#include <hive/name.hpp>

#include <asio/dispatch.hpp>
#include <asio/post.hpp>

#include <algorithm>
#include <future>
#include <pthread.h>
#include <signal.h>

namespace hive::event {

using protocol::PacketType;

namespace {

constexpr auto tick_period = std::chrono::milliseconds(20);
constexpr auto patience_at_end = std::chrono::milliseconds(300);
constexpr std::size_t most_peers = 256;
constexpr std::size_t most_registrations = 64;  ///< of one peer
constexpr std::size_t most_requests = 32;       ///< of one peer, under way

std::vector<std::string> names_of(const std::list<Outlet>& outlets)
{
    std::vector<std::string> names;
    for (const auto& outlet : outlets)
        names.push_back(outlet.port().name);
    return names;
}

/// Signals are for the user thread.
void block_signals()
{
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace

void Door::post(std::function<void()> task)
{
    const std::lock_guard lock(mutex_);
    if (context_)
        asio::post(*context_, std::move(task));
}

void Door::shut()
{
    const std::lock_guard lock(mutex_);
    context_ = nullptr;
}

Module::Module(Options options) : options_(std::move(options)) {}

Module::~Module() { end(); }

void Module::end()
{
    if (thread_.joinable()) {
        leave();
        call([this] { close_links(); });
        work_.reset();
        thread_.join();
    }
    door_->shut();
}

/// Deregisters everywhere and waits a moment for the confirmations, so that nobody takes the end for a loss.
void Module::leave()
{
    struct Leaving {
        std::promise<void> all_left;
        std::size_t remaining = 1;
        void one_left()
        {
            if (--remaining == 0)
                all_left.set_value();
        }
    };
    const auto leaving = std::make_shared<Leaving>();
    call([&] {
        ending_ = true;
        listeners_.clear();
        for (const auto& intake : std::exchange(intakes_, {})) {
            ++leaving->remaining;
            intake->stop([leaving] { leaving->one_left(); });
        }
        leaving->one_left();
    });
    leaving->all_left.get_future().wait_for(patience_at_end);
}

void Module::close_links()
{
    signals_.cancel();
    timer_.cancel();  // a tick that is due in 20 ms would hold up the end of a command that long
    for (const auto& link : std::set(links_))
        link->close(Error(Errc::stopped, options_.self.name + " is ending"));
    if (links_.empty() && dialing_.empty())
        return;
    // What is left are closings and dials under way: a peer that does not answer is not waited for.
    last_.expires_after(patience_at_end);
    last_.async_wait([this](std::error_code problem) {
        if (!problem)
            context_.stop();
    });
}

void Module::on_signal(std::function<void(int)> handler)
{
    signals_.add(SIGINT);
    signals_.add(SIGTERM);
    signals_.async_wait([handler = std::move(handler)](std::error_code problem, int number) {
        if (!problem)
            handler(number);
    });
}

void Module::start()
{
    thread_ = std::thread([this] {
        block_signals();
        context_.run();
    });
}

void Module::call(const std::function<void()>& task)
{
    std::promise<void> promise;
    auto done = promise.get_future();
    asio::dispatch(context_, [&] {
        try {
            task();
            promise.set_value();
        } catch (...) {
            promise.set_exception(std::current_exception());
        }
    });
    done.get();
}

void Module::halt(bool halted)
{
    halted_ = halted;
    post([this] {
        for (const auto& intake : intakes_)
            intake->flush();
    });
}

Outlet& Module::add_outlet(Port port, PacketType carrier)
{
    return outlets_.emplace_back(std::move(port), carrier, [this] { demand_changed(); }, [this](const EmissionPtr& event) { on_failed(event); });
}

transport::Address Module::listen(const transport::Address& address)
{
    listeners_.push_back(transport::listen(
        context_, address,
        [this](std::shared_ptr<transport::Connection> connection) {
            if (links_.size() >= most_peers) {
                log("refused " + connection->peer() + ": " + std::to_string(most_peers) + " peers are connected already");
                return;
            }
            adopt(make_link(std::move(connection)), [](const LinkPtr&, const Error&) {});
        },
        options_.timing));
    return listeners_.back()->address();
}

LinkPtr Module::make_link(std::shared_ptr<transport::Connection> connection)
{
    return std::make_shared<Link>(std::move(connection), options_.self, options_.limits);
}

void Module::adopt(const LinkPtr& link, std::function<void(const LinkPtr&, const Error&)> ready)
{
    links_.insert(link);
    const auto told = std::make_shared<bool>(false);
    link->start({.opened =
                     [ready, told](Link& opened) {
                         *told = true;
                         ready(opened.shared_from_this(), Error(Errc::failed, ""));
                     },
                 .packet = [this](Link& from, const protocol::Packet& packet, const Json& header) { on_packet(from, packet, header); },
                 .closed =
                     [this, ready, told](Link& closed, const Error& reason) {
                         const auto keep = closed.shared_from_this();
                         on_closed(closed, reason);
                         if (!*told)
                             ready(nullptr, reason);
                     }});
}

void Module::with_link(const transport::Address& address, Clock::time_point deadline, OnLink on_link)
{
    const auto key = to_text(address);
    if (const auto found = dialed_.find(key); found != dialed_.end())
        return on_link(found->second, Error(Errc::failed, ""));
    auto& waiting = dialing_[key];
    waiting.push_back({deadline, std::move(on_link)});
    arm();
    if (waiting.size() > 1)
        return;
    const auto patience = std::max(std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()), std::chrono::milliseconds(1));
    transport::dial(
        context_, address, patience,
        [this, key](std::shared_ptr<transport::Connection> connection, std::exception_ptr problem) {
            if (connection)
                return adopt(make_link(std::move(connection)), [this, key](const LinkPtr& link, const Error& error) { dialed(key, link, error); });
            try {
                std::rethrow_exception(problem);
            } catch (const Error& error) {
                dialed(key, nullptr, error);
            }
        },
        options_.timing);
}

void Module::dialed(const std::string& key, const LinkPtr& link, const Error& error)
{
    auto node = dialing_.extract(key);
    if (link)
        dialed_[key] = link;
    if (!node.empty())
        for (const auto& waiting : node.mapped())
            waiting.on_link(link, error);
}

void Module::request(const transport::Address& address, PacketType type, Json header, Body body, Clock::time_point deadline, OnOutcome on_outcome)
{
    with_link(address, deadline,
              [this, type, header = std::move(header), body = std::move(body), deadline, on_outcome = std::move(on_outcome)](
                  const LinkPtr& link, const Error& error) {
                  if (!link)
                      return on_outcome(error);
                  link->request(type, header, body, deadline, on_outcome);
                  arm();
              });
}

void Module::on_packet(Link& link, const protocol::Packet& packet, const Json& header)
{
    switch (packet.type) {
    case PacketType::register_receiver: return on_register(link, packet, header);
    case PacketType::deregister: return on_deregister(link, packet, header);
    case PacketType::request: {
        const auto request = protocol::request_from_json(header);
        for (auto& outlet : outlets_)
            outlet.request(link, packet.channel, request);
        return arm();
    }
    default: return on_request_packet(link, packet, header);
    }
}

Outlet& Module::outlet(const std::string& name)
{
    for (auto& outlet : outlets_)
        if (outlet.port().name == name)
            return outlet;
    const auto near = nearest(name, names_of(outlets_));
    throw Error(Errc::not_found, options_.self.name + " has no output " + name + (near.empty() ? "" : "; did you mean " + near + "?"));
}

void Module::on_register(Link& link, const protocol::Packet& packet, const Json& header)
{
    const auto id = Fields(header, "register").integer("id", 0, max_json_integer);
    try {
        const auto registration = protocol::registration_from_json(header);
        require_free(link, packet.channel);
        Outlet& sender = outlet(registration.output);
        sender.require_fit(registration);
        // The confirmation leaves before the first event.
        link.answer(id, Json{{"type", sender.port().type}, {"kind", options_.self.kind}, {"epoch", options_.self.epoch}});
        sender.add(link.shared_from_this(), packet.channel, registration);
    } catch (const Error& error) {
        link.answer(id, error);
    }
    arm();
}

void Module::require_free(const Link& link, std::uint16_t channel) const
{
    if (channel == 0)
        throw Error(Errc::invalid_argument, "register: channel 0 is no channel");
    std::size_t registrations = 0;
    for (const auto& outlet : outlets_) {
        if (outlet.has(link, channel))
            throw Error(Errc::invalid_argument, "register: channel " + std::to_string(channel) + " is in use");
        registrations += outlet.receivers(link);
    }
    if (registrations >= most_registrations)
        throw Error(Errc::refused, options_.self.name + " takes " + std::to_string(most_registrations) + " registrations of one peer");
}

void Module::on_deregister(Link& link, const protocol::Packet& packet, const Json& header)
{
    const auto id = Fields(header, "deregister").integer("id", 0, max_json_integer);
    bool found = false;
    for (auto& outlet : outlets_)
        found = outlet.remove(link, packet.channel) || found;
    if (found)
        link.answer(id, Json::object());
    else
        link.answer(id, Error(Errc::not_found, "nothing is registered on channel " + std::to_string(packet.channel)));
}

void Module::on_request_packet(Link& link, const protocol::Packet& packet, const Json& header)
{
    const auto id = Fields(header, protocol::token(packet.type)).integer("id", 0, max_json_integer);
    const auto handler = handlers_.find(packet.type);
    if (handler == handlers_.end())
        return link.answer(id, Error(Errc::unsupported, options_.self.name + " does not know the request " + std::string(protocol::token(packet.type))));
    if (link.under_way >= most_requests)
        return link.answer(id, Error(Errc::refused, std::to_string(most_requests) + " requests of yours are under way; wait for an answer"));
    ++link.under_way;
    const auto send = [weak = link.weak_from_this(), id](const Outcome& outcome) {
        const auto to = weak.lock();
        if (!to || !to->open())
            return;
        --to->under_way;
        to->answer(id, outcome);
    };
    const auto answer = [door = door_, send, network = std::this_thread::get_id()](const Outcome& outcome) {
        if (std::this_thread::get_id() == network)
            return send(outcome);
        door->post([send, outcome] { send(outcome); });
    };
    try {
        handler->second({link.peer().name, header, packet.body, answer});
    } catch (const Error& error) {
        send(error);
    }
}

void Module::on_closed(Link& link, const Error& reason)
{
    if (reason.code() == Errc::malformed || reason.code() == Errc::too_large || reason.code() == Errc::version_mismatch)
        log("closed " + link.connection().peer() + ": " + reason.what());
    std::erase_if(dialed_, [&](const auto& row) { return row.second.get() == &link; });
    links_.erase(link.shared_from_this());
    if (ending_ && links_.empty())
        last_.cancel();
    for (auto& outlet : outlets_)
        outlet.link_closed(link);
    for (const auto& intake : std::vector(intakes_))
        intake->link_closed(link);
}

std::shared_ptr<Intake> Module::add_intake(IntakeSpec spec, Intake::Sink sink)
{
    return intakes_.emplace_back(std::make_shared<Intake>(*this, std::move(spec), std::move(sink)));
}

void Module::remove_intake(const std::shared_ptr<Intake>& intake, std::function<void()> left)
{
    intake->stop(std::move(left));
    std::erase(intakes_, intake);
}

void Module::emit(Outlet& outlet, EmissionPtr event)
{
    const bool nobody = std::ranges::none_of(outlets_, [](const Outlet& each) { return each.carrier() == PacketType::event && each.wanted(); });
    outlet.offer(std::move(event), nobody);
    arm();
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
    const bool needed = !dialing_.empty() || std::ranges::any_of(links_, [](const LinkPtr& link) { return link->pending(); })
        || std::ranges::any_of(outlets_, &Outlet::leasing);
    if (!needed)
        return;
    armed_ = true;
    timer_.expires_after(tick_period);
    timer_.async_wait([this](std::error_code problem) {
        armed_ = false;
        if (!problem)
            tick();
    });
}

/// A peer that accepts and says nothing must not keep anybody beyond its own deadline.
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
        waiting.on_link(nullptr, Error(Errc::timeout, "no sign of life within the time allowed"));
}

void Module::tick()
{
    const auto now = Clock::now();
    for (const auto& link : std::set(links_))
        link->expire(now);
    expire_dialing(now);
    for (auto& outlet : outlets_)
        if (outlet.leasing())
            outlet.tick();
    arm();
}

}  // namespace hive::event
