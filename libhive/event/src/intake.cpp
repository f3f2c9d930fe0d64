// Registering, credit and receipts at the receiving end.
#include <hive/event/emission.hpp>
#include <hive/event/intake.hpp>
#include <hive/event/module.hpp>

#include <asio/post.hpp>

namespace hive::event {

using protocol::PacketType;

namespace {

using namespace std::chrono_literals;

constexpr auto patience = 3s;  // for one attempt to dial and register

Backoff backoff_for(const transport::Address& address)
{
    // A local socket that is not there costs nothing to try, so a restarted drone is met again at once.
    const bool local = address.scheme != transport::Address::Scheme::tcp;
    return {local ? 50ms : 100ms, local ? 300ms : 4000ms, static_cast<std::uint32_t>(wall_us())};
}

}  // namespace

Intake::Intake(Module& module, IntakeSpec spec, Sink sink)
    : module_(module),
      spec_(std::move(spec)),
      sink_(std::move(sink)),
      backoff_(backoff_for(spec_.address)),
      timer_(module.context())
{
}

void Intake::start(OnOutcome first)
{
    first_ = std::move(first);
    attempt();
}

void Intake::attempt()
{
    const auto deadline = Clock::now() + patience;
    module_.with_link(
        spec_.address, deadline, [self = shared_from_this(), deadline](const LinkPtr& link, const Error& error) {
            if (self->stopped_)
                return;
            if (!link)
                return self->failed(error);
            self->link_ = link;
            self->epoch_ = std::max(self->epoch_ + 1, wall_us());
            self->arrived_ = self->finished_ = self->acknowledged_ = 0;
            self->asked_ = self->spec_.options.window;
            self->outstanding_.clear();
            self->channel_ = link->claim_channel([weak = std::weak_ptr(self)](const protocol::Packet& packet) {
                if (const auto intake = weak.lock())
                    intake->on_packet(packet);
            });
            const protocol::Registration registration{.id = 0,
                                                      .epoch = self->epoch_,
                                                      .output = self->spec_.output,
                                                      .receiver = self->spec_.receiver,
                                                      .accepts = self->spec_.accepts,
                                                      .stateful = self->spec_.stateful,
                                                      .options = self->spec_.options};
            link->request(
                PacketType::register_receiver, to_json(registration), {}, deadline,
                [self, link](const Outcome& outcome) { self->registered(link, outcome); }, self->channel_);
            self->module_.arm();
        });
}

void Intake::registered(const LinkPtr& link, const Outcome& outcome)
{
    if (stopped_ || link != link_)
        return;
    if (const auto* error = std::get_if<Error>(&outcome)) {
        link->release_channel(channel_);
        link_.reset();
        return failed(*error);
    }
    connected_ = true;
    error_.clear();
    backoff_.reset();
    if (const auto first = std::exchange(first_, {}))
        first(outcome);
    flush();
}

void Intake::failed(const Error& error)
{
    error_ = error.what();
    if (const auto first = std::exchange(first_, {}))
        first(error);
    if (!stopped_)
        retry();
}

void Intake::retry()
{
    timer_.expires_after(backoff_.next());
    timer_.async_wait([weak = weak_from_this()](std::error_code problem) {
        if (const auto self = weak.lock(); self && !problem && !self->stopped_)
            self->attempt();
    });
}

void Intake::stop(std::function<void()> left)
{
    stopped_ = true;
    timer_.cancel();
    connected_ = false;
    const auto link = std::exchange(link_, nullptr);
    if (!link || !link->open())
        return left();
    link->release_channel(channel_);
    link->request(
        PacketType::deregister, Json::object(), {}, Clock::now() + patience, [left](const Outcome&) { left(); },
        channel_);
    module_.arm();
}

void Intake::link_closed(const Link& link)
{
    if (link_.get() != &link)
        return;
    link_.reset();
    if (!std::exchange(connected_, false))
        return;  // the pending registration reports it
    error_ = "connection lost";
    retry();
}

void Intake::on_packet(const protocol::Packet& packet)
{
    if (stopped_)
        return;
    if (spec_.options.transfer == Transfer::synchronized && arrived_ >= asked_)
        throw Error(Errc::malformed, spec_.sender + "." + spec_.output + " sent more events than it was asked for");
    Event event = event_from_packet(packet);
    ++received_;
    age_us_ = event.age().count();
    if (packet.type == PacketType::notification)
        event.identity.lossless = false;  // it may be skipped, so what comes of it is held for nobody
    event.input = spec_.input;
    event.receipt = receipt(++arrived_);
    outstanding_.insert(arrived_);
    sink_(std::move(event));
}

std::shared_ptr<const void> Intake::receipt(std::int64_t number)
{
    static constexpr char held = 0;  // not null, so that an event with a receipt can be told from one without
    return {&held, [door = module_.door(), weak = weak_from_this(), epoch = epoch_, number](const void*) {
                door->post([weak, epoch, number] {
                    if (const auto self = weak.lock())
                        self->finished(epoch, number);
                });
            }};
}

void Intake::finished(std::int64_t epoch, std::int64_t number)
{
    ++processed_;
    if (epoch != epoch_)
        return;
    outstanding_.erase(number);
    ++finished_;
    flush();
}

std::int64_t Intake::done() const { return outstanding_.empty() ? arrived_ : *outstanding_.begin() - 1; }

void Intake::flush()
{
    if (!connected_ || spec_.options.transfer == Transfer::streaming)
        return;
    const auto ask = module_.paused() ? asked_ : spec_.options.window + finished_;
    const auto acknowledge = done();
    if (ask == asked_ && (acknowledge == acknowledged_ || spec_.options.group.empty()))
        return;
    asked_ = ask;
    acknowledged_ = acknowledge;
    link_->connection().send(
        protocol::make_packet(PacketType::request, protocol::to_text({epoch_, ask, acknowledge}), channel_));
}

Json Intake::status() const
{
    Json json = to_json(spec_.options);
    json["input"] = spec_.input;
    json["from"] = spec_.sender + "." + spec_.output;
    json["state"] = connected_ ? "connected" : "waiting";
    json["received"] = received_;
    json["processed"] = processed_;
    json["dropped"] = lost.load();
    json["last_age_us"] = age_us_;
    json["error"] = error_;
    return json;
}

}  // namespace hive::event
