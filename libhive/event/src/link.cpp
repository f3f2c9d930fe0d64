// Hello, requests with deadlines, dispatch by channel.
#include <hive/event/link.hpp>
#include <hive/printable.hpp>

namespace hive::event {

using protocol::Packet;
using protocol::PacketType;

namespace {

/// A peer would close the connection for more, with everything else on it.
void require_acceptable(const Json& header, const std::string& text, const Body& body)
{
    constexpr protocol::Limits limits;
    require_within(header);
    require_at_most("a header", text.size(), limits.header);
    require_at_most("a body", body.size(), limits.body);
}

}  // namespace

Link::Link(std::shared_ptr<transport::Connection> connection, End end, const protocol::Hello& self,
           protocol::Limits limits, std::shared_ptr<transport::Pool> pool, bool maps)
    : connection_(std::move(connection)), end_(end), self_(self), limits_(limits), pool_(std::move(pool))
{
    self_.maps = maps && connection_->can_share();
}

void Link::start(Events events)
{
    events_ = std::move(events);
    const auto self = shared_from_this();
    connection_->start(
        {.packet = [self](Packet&& packet) { self->on_packet(packet); },
         .closed = [self](const Error& reason) { self->on_closed(reason); },
         .wants = [self](PacketType type, std::uint16_t channel) { return self->wants(type, channel); }});
    connection_->send(protocol::make_packet(PacketType::hello, to_text(protocol::to_json(self_))));
}

protocol::Direction Link::to_here() const
{
    return end_ == End::dialed ? protocol::Direction::to_dialer : protocol::Direction::to_listener;
}

protocol::Direction Link::to_peer() const
{
    return end_ == End::dialed ? protocol::Direction::to_listener : protocol::Direction::to_dialer;
}

/// Checked before the packet is read.
bool Link::wants(PacketType type, std::uint16_t channel) const
{
    if (const auto role = credentials().role; !permits(role, to_here(), type))
        throw Error(Errc::not_permitted, refusal(role, to_here(), type));
    return (type != PacketType::event && type != PacketType::reference) || channels_.contains(channel);
}

void Link::on_packet(const Packet& packet)
{
    try {
        if (!open_)
            return on_hello(packet);
        if (packet.type == PacketType::event || packet.type == PacketType::notification
            || packet.type == PacketType::exception || packet.type == PacketType::end) {
            if (const auto sink = channels_.find(packet.channel); sink != channels_.end())
                (*std::shared_ptr(sink->second))(packet);  // a copy: the sink may release its channel
            return;
        }
        used_ = Clock::now();
        if (packet.type == PacketType::confirmation)
            return on_confirmation(parse_json(packet.header_text()));
        if (packet.type == PacketType::hello)
            throw Error(Errc::malformed, "a second hello");
        take(packet);
    } catch (const Error& error) {
        connection_->close(error);
    }
}

/// A request of the peer.
void Link::take(const Packet& packet)
{
    constexpr std::size_t max_deferred = 128, max_size = 64 * 1024;
    if (defers_ == 0)
        return events_.packet(*this, packet);
    if (deferred_.size() == max_deferred || packet.size() > max_size)
        throw Error(Errc::too_large, "it has to wait for its earlier run, and sends more than can be kept meanwhile");
    deferred_.push_back(packet);
}

void Link::go_on()
{
    if (--defers_ > 0)
        return;
    try {
        for (; open_ && !deferred_.empty(); deferred_.pop_front())
            events_.packet(*this, deferred_.front());
    } catch (const Error& error) {
        connection_->close(error);
    }
}

void Link::on_hello(const Packet& packet)
{
    peer_ = protocol::hello_from_json(parse_json(packet.header_text()));
    if (peer_.name == self_.name && peer_.epoch == self_.epoch && peer_.pid == self_.pid)
        throw Error(Errc::invalid_argument, self_.name + " met itself");
    open_ = true;
    used_ = Clock::now();
    connection_->open(limits_);
    if (peer_.maps && connection_->can_share())
        connection_->share(pool_);
    events_.opened(*this);
}

void Link::on_confirmation(Json header)
{
    auto confirmation = protocol::confirmation_from_json(std::move(header));
    const auto found = pending_.find(confirmation.id);
    if (found == pending_.end())
        return;  // its deadline has passed
    if (confirmation.time_us != 0 && !local())
        peer_clock_.answered(found->second.asked, Clock::now(), found->second.asked_wall_us, confirmation.time_us);
    const auto on_outcome = std::move(found->second.on_outcome);
    pending_.erase(found);
    if (confirmation.ok)
        on_outcome(std::move(confirmation.result));
    else
        on_outcome(Error(confirmation.code, confirmation.text, confirmation.advice));
}

void Link::on_closed(const Error& reason)
{
    open_ = false;
    const auto events = std::exchange(events_, {});
    channels_.clear();
    deferred_.clear();
    for (auto& [id, pending] : std::exchange(pending_, {}))
        pending.on_outcome(reason.reworded(pending.what + ": " + reason.what()));
    if (events.closed)
        events.closed(*this, reason);
}

void Link::request(PacketType type, Json header, Body body, Clock::time_point deadline, OnOutcome on_outcome,
                   std::uint16_t channel)
{
    const auto id = ++next_id_;
    header["id"] = id;
    auto text = to_text(header);
    const auto what = std::string(protocol::token(type)) + " to " + peer_.name;
    try {
        if (const auto role = credentials().role; !permits(role, to_peer(), type))
            throw Error(Errc::not_permitted, refusal(role, to_peer(), type), "use the members' key: hivectl key show");
        require_acceptable(header, text, body);
    } catch (const Error& error) {
        return on_outcome(error.reworded(what + ": " + error.what()));
    }
    pending_[id] = {deadline, std::move(on_outcome), what, Clock::now(), wall_us()};
    connection_->send(protocol::make_packet(type, std::move(text), channel, std::move(body)));
}

/// The status of a drone has the time like any answer, is answered at once, and is short without rows.
void Link::ask_time()
{
    const auto now = Clock::now();
    if (!open_ || local() || asking_time_ || now < peer_clock_.due())
        return;
    asking_time_ = true;
    request(PacketType::status, {{"skip", max_json_integer}}, {}, now + std::chrono::seconds(2),
            [this](const Outcome&) { asking_time_ = false; });
}

void Link::answer(std::int64_t id, Outcome outcome)
{
    protocol::Confirmation confirmation{
        .id = id, .result = {}, .ok = true, .code = {}, .text = {}, .advice = {}, .time_us = local() ? 0 : wall_us()};
    if (const auto* error = std::get_if<Error>(&outcome)) {
        confirmation.ok = false;
        confirmation.code = error->code();
        confirmation.text = shortened(error->what());
        confirmation.advice = shortened(error->advice());
    } else {
        confirmation.result = std::get<Json>(std::move(outcome));
    }
    const Json header = protocol::to_json(std::move(confirmation));
    auto text = to_text(header);
    try {
        require_acceptable(header, text, {});
    } catch (const Error& error) {
        return answer(id, error);
    }
    // A peer that sends requests faster than it reads answers keeps its connection: the short answer fits.
    constexpr std::size_t short_answer = 1024;
    if (text.size() > short_answer && !connection_->has_room(text.size() + 32 * short_answer))
        return answer(id, Error(Errc::refused, "answers to earlier requests wait to be read"));
    connection_->send(protocol::make_packet(PacketType::confirmation, std::move(text)));
}

void Link::expire(Clock::time_point now)
{
    std::vector<Pending> late;
    for (auto it = pending_.begin(); it != pending_.end();)
        if (it->second.deadline <= now) {
            late.push_back(std::move(it->second));
            it = pending_.erase(it);
        } else {
            ++it;
        }
    for (const auto& request : late)
        request.on_outcome(Error(Errc::timeout, request.what + ": no answer in time"));
}

std::uint16_t Link::claim_channel(ChannelSink sink)
{
    if (channels_.size() >= 1024)
        throw Error(Errc::too_large, "more than 1024 registrations on one connection");
    do
        ++next_channel_;
    while (next_channel_ == 0 || channels_.contains(next_channel_));
    channels_[next_channel_] = std::make_shared<const ChannelSink>(std::move(sink));
    return next_channel_;
}

void Link::release_channel(std::uint16_t channel) { channels_.erase(channel); }

std::string without_port(const std::string& place) { return place.substr(0, place.rfind(':')); }

}  // namespace hive::event
