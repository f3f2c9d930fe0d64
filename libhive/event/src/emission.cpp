// Encodes events into packets and decodes them.
#include "header_text.hpp"

#include <hive/error.hpp>
#include <hive/event/emission.hpp>
#include <hive/event/clock.hpp>
#include <hive/event_text.hpp>
#include <hive/name.hpp>

#include <algorithm>

namespace hive {

const Share* Identity::shared_work() const
{
    const auto found = std::ranges::find_if(shares, &Share::group);
    return found == shares.end() ? nullptr : &*found;
}

std::chrono::microseconds Event::age() const
{
    const auto here_us = identity.captured_us - identity.offset_us;  // in the clock of this machine
    return std::chrono::microseconds(identity.captured_us == 0 ? 0 : event::wall_us() - here_us);
}

}  // namespace hive

namespace hive::event {
namespace {

Share share_from(const Fields& fields)
{
    Share share;
    share.of = fields.text("of");
    if (!is_share_name(share.of))
        throw Error(Errc::malformed, "share: \"of\" must be DRONE.OUTPUT or DRONE.OUTPUT#GROUP");
    share.epoch = fields.integer("epoch", 0, max_json_integer);
    share.turn = fields.integer("turn", 0, max_json_integer);
    share.attempt = static_cast<int>(fields.integer_or("attempt", 0, most_attempts, 1));
    share.closed = fields.integer_or("closed", 0, max_json_integer, 0);
    share.part = static_cast<int>(fields.integer_or("part", 0, most_part, 0));
    share.each = fields.flag_or("each", false);
    share.to = fields.name_or("to", "");
    return share;
}

Identity identity_from(const Fields& fields)
{
    Identity identity;
    identity.source = fields.name("source");
    identity.epoch = fields.integer("epoch", 0, max_json_integer);
    identity.sequence = fields.integer("seq", 0, max_json_integer);
    identity.captured_us = fields.integer_or("time_us", 0, max_json_integer, 0);
    identity.monotonic_us = fields.integer_or("mono_us", 0, max_json_integer, 0);
    identity.offset_us = fields.integer_or("offset_us", -max_json_integer, max_json_integer, 0);
    identity.lossless = fields.flag_or("lossless", false);
    identity.part = static_cast<int>(fields.integer_or("part", 0, most_part, 0));
    if (fields.has("shares"))
        for (const auto& item : fields.array("shares")) {
            if (identity.shares.size() == most_shares)
                throw Error(Errc::malformed, "event: more than 16 shares");
            identity.shares.push_back(share_from(Fields(item, "share")));
        }
    if (fields.has("hops"))
        for (const auto& item : fields.array("hops")) {
            if (identity.hops.size() == most_hops)
                throw Error(Errc::malformed, "event: more than 16 hops");
            const Fields hop(item, "hop");
            identity.hops.push_back({hop.name("drone"), hop.integer_or("wait_us", 0, max_json_integer, 0),
                                     hop.integer_or("work_us", 0, max_json_integer, 0)});
        }
    return identity;
}

Event event_from_json(const Json& json, std::size_t body_size)
{
    const Fields fields(json, "event");
    Event event;
    event.identity = identity_from(fields);
    event.sender = fields.name("sender");
    event.kind = fields.name("kind");
    event.output = fields.name("output");
    event.type = fields.text("type");
    event.size =
        static_cast<std::size_t>(fields.integer_or("size", 0, max_json_integer, static_cast<std::int64_t>(body_size)));
    event.sized = fields.has("size") || body_size > 0;
    if (fields.has("header"))
        event.header = fields.object("header");
    return event;
}

}  // namespace

bool is_share_name(std::string_view text)
{
    const auto sharp = text.find('#'), dot = text.substr(0, sharp).rfind('.');
    return dot != std::string_view::npos && is_name(text.substr(0, dot))
           && is_name(text.substr(0, sharp).substr(dot + 1))
           && (sharp == std::string_view::npos || is_name(text.substr(sharp + 1)));
}

Emission::Emission(Event event, bool complete, std::optional<Share> own)
    : event_(std::move(event)), complete_(complete), own_(std::move(own))
{
    // Without a body, only the emitter can know the size, such as a recording that stores it elsewhere.
    event_.sized = event_.sized && (complete || event_.size > 0);
    header_ = std::make_shared<const std::string>(header_text(event_, own_ ? &*own_ : nullptr));
    require_within(event_.header, {}, 1);
    constexpr std::size_t share_bytes = 512;  // added by sharing
    if (header_->size() + share_bytes > protocol::Limits{}.header)
        throw Error(Errc::too_large, "the header of an event is " + std::to_string(header_->size()) + " bytes, limit "
                                         + std::to_string(protocol::Limits{}.header)
                                         + ": put large data into the body");
    if (event_.identity.shares.size() >= most_shares)
        throw Error(Errc::refused, "this event has gone through 16 shared or lossless stages, which is the limit");
}

std::shared_ptr<const Emission> Emission::without_ticket() const
{
    auto copy = std::make_shared<Emission>(*this);
    copy->event_.ticket = {};
    return copy;
}

std::shared_ptr<const Emission> Emission::given_up(const std::optional<Share>& last) const
{
    auto copy = std::make_shared<Emission>(*this);
    copy->own_ = last;
    return copy;
}

protocol::Packet Emission::packet(protocol::PacketType type, std::uint16_t channel,
                                  const std::optional<Share>& share) const
{
    auto header = share ? std::make_shared<const std::string>(header_text(event_, &*share)) : header_;
    return {type, channel, std::move(header), type == protocol::PacketType::notification ? Body() : event_.body};
}

std::shared_ptr<const Emission> Emission::rendition(const std::string& encoding) const
{
    const std::lock_guard lock(renditions_->mutex);
    const auto found = renditions_->made.find(encoding);
    return found == renditions_->made.end() ? nullptr : found->second;
}

void Emission::keep_rendition(const std::string& encoding, std::shared_ptr<const Emission> rendition) const
{
    const std::lock_guard lock(renditions_->mutex);
    renditions_->made[encoding] = std::move(rendition);
}

Event event_from_packet(const protocol::Packet& packet)
{
    Event event = event_from_text(packet.header_text(), packet.body);
    event.sized = event.sized || packet.type != protocol::PacketType::notification;  // otherwise the body has it
    event.received = Clock::now();
    return event;
}

}  // namespace hive::event

namespace hive {

std::string event_text(const Event& event) { return event::header_text(event, nullptr); }

Event event_from_text(std::string_view text, Body body)
{
    Event event;
    event.size = body.size();
    event.sized = !body.empty();
    if (!event::read_plain_header(text, event))
        event = event::event_from_json(parse_json(text), body.size());
    event.body = std::move(body);
    return event;
}

}  // namespace hive
