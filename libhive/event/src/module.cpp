// The life of a module: its end, what it owns, its timer.
#include <hive/event/module.hpp>

#include <algorithm>
#include <csignal>

namespace hive::event {

using protocol::PacketType;

namespace {

constexpr auto tick_period = std::chrono::milliseconds(20);
constexpr auto patience_at_end = std::chrono::milliseconds(300);
constexpr std::size_t most_peers = 256;

}  // namespace

void Door::post(Loop::Task task)
{
    const std::lock_guard lock(mutex_);
    if (loop_)
        loop_->post(std::move(task));
}

bool Door::inside()
{
    const std::lock_guard lock(mutex_);
    return loop_ && loop_->has_turn();
}

void Door::shut()
{
    const std::lock_guard lock(mutex_);
    loop_ = nullptr;
}

Module::Module(Options options) : options_(std::move(options)) {}

Module::~Module() { end(); }

void Module::end()
{
    encoder_thread_.end();
    if (loop_.started()) {
        leave();
        call([this] { close_links(); });
        loop_.end();
    }
    door_->shut();
    pool_->end();
}

/// Deregisters everywhere and waits a moment for the confirmations, so that nobody takes the end for a loss.
void Module::leave()
{
    const auto remaining = std::make_shared<std::size_t>(0);
    call([&] {
        ending_ = true;
        listeners_.clear();
        for (const auto& intake : std::exchange(intakes_, {})) {
            ++*remaining;
            intake->stop([remaining] { --*remaining; });
        }
    });
    loop_.wait(Clock::now() + patience_at_end, [&] { return *remaining == 0; });
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
            context().stop();
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

void Module::start() { loop_.start(); }

std::optional<Mailbox::Item> Module::next(Mailbox& mailbox, Clock::time_point deadline)
{
    const auto ready = [&] { return mailbox.ready(!halted_); };
    if (ready())
        loop_.serve();  // what the last item left behind, its receipt and what it emitted, is not for later
    else
        loop_.wait(deadline, ready);
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
        .not_encoded = [this](const EmissionPtr& event, const Error& problem) { on_not_encoded(event, problem); },
        .on_encoder_thread = [this](std::function<void()> job) { encoder_thread_.push(std::move(job)); },
        .on_network_side = [this](std::function<void()> task) { post(std::move(task)); }};
    return outlets_.emplace_back(std::move(port), carrier, std::move(encoder), std::move(hooks));
}

transport::Address Module::listen(const transport::Address& address)
{
    listeners_.push_back(transport::listen(
        context(), address,
        [this](std::shared_ptr<transport::Connection> connection) {
            if (links_.size() >= most_peers) {
                log("refused " + connection->peer() + ": " + std::to_string(most_peers)
                    + " peers are connected already");
                return;
            }
            adopt(make_link(std::move(connection)), [](const LinkPtr&, const Error&) {});
        },
        options_.timing));
    return listeners_.back()->address();
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
    const auto gives_events = [](const Outlet& each) { return each.carrier() == PacketType::event; };
    const bool nobody =
        std::ranges::none_of(outlets_, [&](const Outlet& each) { return gives_events(each) && each.wanted(); });
    outlet.offer(std::move(event),
                 gives_events(outlet) && nobody);  // an exception is told to whoever listens, and waits for nobody
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

Alarm Module::alarm(Clock::time_point time, Loop::Task task)
{
    auto timer = std::make_shared<asio::steady_timer>(context(), time);
    timer->async_wait([task = std::move(task)](std::error_code problem) {
        if (!problem)
            task();
    });
    return timer;
}

void Module::arm()
{
    if (armed_)
        return;
    const bool needed = !dialing_.empty()
                        || std::ranges::any_of(links_, [](const LinkPtr& link) { return link->pending(); })
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
