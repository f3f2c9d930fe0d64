// Reads, writes, watches and ends a connection.
#include "connection_core.hpp"

#include <asio/error.hpp>
#include <asio/post.hpp>

#include <limits>

namespace hive::transport {

using Clock = Liveness::Clock;

ConnectionCore::ConnectionCore(asio::io_context& context, std::unique_ptr<Stream> stream, const Timing& timing,
                               std::shared_ptr<void> admission)
    : context_(context),
      stream_(std::move(stream)),
      peer_(stream_->peer()),
      timing_(timing),
      admission_(std::move(admission)),
      timer_(context),
      liveness_(timing, Clock::now())
{
}

void ConnectionCore::start(Connection::Handlers handlers)
{
    handlers_ = std::make_shared<Connection::Handlers>(std::move(handlers));
    if (ended_) {
        asio::post(context_, [told = std::exchange(handlers_, nullptr), reason = *ended_] {
            if (told->closed)
                told->closed(reason);
        });
        return;
    }
    liveness_ = Liveness(timing_, Clock::now());
    read();
    write();
    look_later();
}

void ConnectionCore::open(const protocol::Limits& limits)
{
    reader_.open(limits);
    most_body_ = limits.body;
    opened_ = true;
    admission_.reset();
    asio::post(context_, [self = shared_from_this()] {
        self->deliver();
        self->read();
    });
}

Carriage ConnectionCore::send(protocol::Packet packet, Connection::Written written)
{
    constexpr auto most = std::numeric_limits<std::uint32_t>::max();
    if (packet.header_text().size() > most || packet.body.size() > most)
        throw Error(Errc::too_large,
                    "a packet of " + std::to_string(packet.size()) + " bytes cannot be sent, 4 GiB is the most");
    if (ended_) {
        if (written)
            asio::post(context_, [written = std::move(written)] { written(false); });
        return Carriage::inside;
    }
    const auto carriage = lend(packet);
    writer_.push(std::move(packet), std::move(written));
    if (writer_.control_bytes() > timing_.control_bytes)
        end(about_peer({Errc::too_large, "it does not read: " + std::to_string(writer_.control_bytes())
                                             + " bytes of control data wait"}));
    else
        write();
    return carriage;
}

void ConnectionCore::ping(std::function<void(bool)> answered)
{
    if (ended_)
        return asio::post(context_, [answered = std::move(answered)] { answered(false); });
    constexpr std::size_t max_unanswered = 1024;
    pings_.push_back({Clock::now(), std::move(answered)});
    if (pings_.size() > max_unanswered)
        return end(about_peer({Errc::malformed, "it answers no ping"}));
    liveness_.pinged(pings_.back().sent);
    send(protocol::make_packet(protocol::PacketType::ping, {}), {});
}

void ConnectionCore::take_pong()
{
    if (pings_.empty())
        return;  // an answer without a ping
    const auto ping = std::move(pings_.front());
    pings_.pop_front();
    liveness_.answered(ping.sent, pings_.size());
    ping.answered(true);
}

/// Replaces a body in shared memory by a reference. The offer of its segment is a control packet, so it arrives first.
Carriage ConnectionCore::lend(protocol::Packet& packet)
{
    if (!lending_ || packet.type != protocol::PacketType::event || packet.body.size() < Pool::least_body)
        return Carriage::inside;
    const auto reference = lending_->lend(packet.body);
    if (!reference)
        return Carriage::fallback;
    if (const auto offer = lending_->offer(*reference))
        writer_.push(protocol::make_packet(protocol::PacketType::segment, hive::to_text(to_json(offer->first))), {},
                     offer->second);
    packet.type = protocol::PacketType::reference;
    packet.body = to_body(*reference);
    return Carriage::reference;
}

void ConnectionCore::end(const Error& reason, bool by_peer)
{
    if (ended_)
        return;
    ended_ = reason;
    ended_by_peer_ = by_peer;
    seemed_dead_ = liveness_.seemed_dead(Clock::now());
    if (borrowing_)
        borrowing_->end();  // before the peer can see the end and reuse its slots
    if (lending_)
        lending_->end(by_peer);
    stream_->close();
    timer_.cancel();
    admission_.reset();
    asio::post(context_, [self = shared_from_this(), told = std::exchange(handlers_, nullptr),
                          unwritten = writer_.drop(), pings = std::exchange(pings_, {})] {
        for (const auto& written : unwritten)
            written(false);
        if (told && told->closed)
            told->closed(*self->ended_);
        for (const auto& ping : pings)
            ping.answered(false);
    });
}

void ConnectionCore::abandon()
{
    if (handlers_)  // their captures are destroyed from the event loop, not inside the user's reset()
        asio::post(context_, [dropped = std::exchange(handlers_, nullptr)] {});
    end(Error(Errc::stopped, "the connection was released"));
}

Error ConnectionCore::about_peer(const Error& error) const { return error.reworded(peer_ + ": " + error.what()); }

Error ConnectionCore::read_failure(std::error_code error) const
{
    if (error == asio::error::no_descriptors)
        return {Errc::io, "no descriptor is left for the memory that it shares"};
    if (error == std::errc::protocol_error)
        return {Errc::malformed, "it sent more descriptors than belong to segments"};
    if (error != asio::error::eof)
        return {Errc::connection_lost, "reading failed: " + error.message()};
    if (reader_.inside())
        return {Errc::connection_lost, "peer ended the connection inside a packet, after " + reader_.progress()};
    return {Errc::connection_lost, "peer ended the connection"};
}

void ConnectionCore::read()
{
    if (ended_ || reading_ || held())
        return;
    reading_ = true;
    stream_->read_some(reader_.space(), [self = shared_from_this()](std::error_code error, std::size_t bytes) {
        self->reading_ = false;
        self->on_read(error, bytes);
    });
}

void ConnectionCore::on_read(std::error_code error, std::size_t bytes)
{
    if (ended_)
        return;
    if (error) {
        const auto failure = read_failure(error);
        return end(about_peer(failure), failure.code() == Errc::connection_lost);
    }
    const bool begins = !reader_.inside();
    reader_.received(bytes);
    const bool ends = deliver() > 0;
    liveness_.heard(Clock::now(), bytes, begins || ends);
    read();
}

/// Passes on whole packets; returns their number.
std::size_t ConnectionCore::deliver()
{
    std::size_t count = 0;
    while (!ended_ && !held())
        if (auto packet = next_packet()) {
            ++count;
            take(std::move(*packet));
        } else
            break;
    return count;
}

std::optional<protocol::Packet> ConnectionCore::next_packet()
{
    try {
        return reader_.next([this](const protocol::Prefix& prefix) { return wants_body(prefix); });
    } catch (const Error& broken) {
        end(about_peer(broken));
        return {};
    }
}

/// References are needed here even if the event is not wanted.
bool ConnectionCore::wants_body(const protocol::Prefix& prefix) const
{
    using protocol::PacketType;
    const bool wanted = !handlers_ || !handlers_->wants || handlers_->wants(prefix.type, prefix.channel);
    return wanted || prefix.type == PacketType::reference || prefix.type == PacketType::release;
}

void ConnectionCore::take(protocol::Packet&& packet)
{
    if (!hello_came_) {
        hello_came_ = true;
        liveness_.hello_came();
    }
    if (packet.type == protocol::PacketType::pong)
        return take_pong();
    if (packet.type == protocol::PacketType::ping) {
        send(protocol::make_packet(protocol::PacketType::pong, {}), {});
        return;
    }
    try {
        if (take_shared(packet))
            return;
    } catch (const Error& broken) {
        return end(about_peer(broken));
    }
    if (const auto told = handlers_; told && told->packet)
        told->packet(std::move(packet));
}

bool ConnectionCore::take_shared(protocol::Packet& packet)
{
    using protocol::PacketType;
    if (packet.type != PacketType::segment && packet.type != PacketType::reference
        && packet.type != PacketType::release)
        return false;
    if (!stream_->passes_descriptors())
        throw Error(Errc::malformed, std::string(token(packet.type)) + ": no memory is shared on this connection");
    if (packet.type == PacketType::release) {
        const auto slots = protocol::slots_from_body(packet.body);  // checked, even if there is nothing to reclaim
        if (lending_)
            lending_->released(slots);
        return true;
    }
    if (!borrowing_)
        borrowing_ = make_borrowing();
    if (packet.type == PacketType::segment) {
        borrowing_->map(protocol::segment_from_json(parse_json(packet.header_text())), stream_->take_descriptor(),
                        most_body_);
        return true;
    }
    const auto reference = protocol::reference_from_body(packet.body);
    if (handlers_ && handlers_->wants && !handlers_->wants(packet.type, packet.channel)) {
        borrowing_->decline(reference, most_body_);
        return true;
    }
    packet.type = PacketType::event;
    packet.body = borrowing_->resolve(reference, most_body_);
    return false;
}

std::unique_ptr<Borrowing> ConnectionCore::make_borrowing()
{
    return std::make_unique<Borrowing>([weak = weak_from_this(), &context = context_] {
        // Twice through the queue, so that the request for the next event, which is in that queue as well, carries the
        // slots.
        asio::post(context, [weak, &context] {
            asio::post(context, [weak] {
                if (const auto self = weak.lock())
                    self->write();
            });
        });
    });
}

void ConnectionCore::give_back()
{
    if (!borrowing_)
        return;
    const auto slots = borrowing_->take_returns();
    if (!slots.empty())
        writer_.push(protocol::make_packet(protocol::PacketType::release, {}, 0, protocol::to_body(slots)), {});
}

void ConnectionCore::write()
{
    if (ended_ || writing_)
        return;
    give_back();
    if (writer_.idle())
        return;
    writing_ = true;
    const auto buffers = writer_.gather();
    const int descriptor = writer_.descriptor();
    if (descriptor < 0)
        if (const auto bytes = stream_->write_now(buffers); bytes > 0)
            return asio::post(context_, [self = shared_from_this(), bytes] { self->on_written({}, bytes); });
    auto on_written = [self = shared_from_this()](std::error_code error, std::size_t bytes) {
        self->on_written(error, bytes);
    };
    if (descriptor >= 0)
        stream_->write_with(descriptor, buffers, std::move(on_written));
    else
        stream_->write_some(buffers, std::move(on_written));
}

// writing_ stays true during the callbacks, so that what they send leaves in one batch.
void ConnectionCore::on_written(std::error_code error, std::size_t bytes)
{
    if (ended_)
        return;
    if (error)
        return end(about_peer({Errc::connection_lost, "writing failed: " + error.message()}), true);
    liveness_.sent(Clock::now());
    for (const auto& written : writer_.wrote(bytes))
        written(true);
    writing_ = false;
    write();
}

void ConnectionCore::look_later()
{
    timer_.run_at(liveness_.next_look(Clock::now(), reader_.inside()), [self = shared_from_this()] {
        if (!self->ended_)
            self->look();
    });
}

void ConnectionCore::look()
{
    const auto now = Clock::now();
    // This end was held up (stopped, suspended, overloaded): what the peer sent meanwhile may still be unread.
    if (const auto late = now - timer_.expiry(); late > timing_.silence / 4)
        liveness_.excuse(late);
    if ((writer_.idle() && liveness_.ping_due(now)) || liveness_.probe_due(now))
        ping([](bool) {});
    if (const auto verdict = liveness_.verdict(now, reader_.inside()))
        return end(about_peer(*verdict));
    if (!ended_)
        look_later();
}

}  // namespace hive::transport
