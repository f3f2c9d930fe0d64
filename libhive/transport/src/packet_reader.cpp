// Assembling packets from a stream of bytes.
#include "packet_reader.hpp"

#include <hive/error.hpp>
#include <hive/protocol/defended.hpp>

#include <algorithm>
#include <cstring>

namespace hive::transport {

PacketReader::PacketReader()
    : buffer_(std::make_unique_for_overwrite<unsigned char[]>(buffer_size)),
      by_first_bytes_(defended("first-bytes")),
      touches_no_pages_(defended("untouched-bodies")),
      judges_(defended("judged-bodies"))
{
}

asio::mutable_buffer PacketReader::space()
{
    if (reads_into_body())
        return {body_.get() + body_filled_, prefix_.body_size - body_filled_};
    if (begin_ != 0) {
        std::memmove(buffer_.get(), buffer_.get() + begin_, end_ - begin_);
        end_ -= begin_;
        begin_ = 0;
    }
    return {buffer_.get() + end_, buffer_size - end_};
}

void PacketReader::received(std::size_t bytes)
{
    if (reads_into_body())
        body_filled_ += bytes;
    else
        end_ += bytes;
}

std::optional<protocol::Packet> PacketReader::next(const Judge& wants_body)
{
    if (part_ == Part::prefix && !take_prefix(wants_body))
        return {};
    if (part_ == Part::header && !take_header())
        return {};
    if (!take_body())
        return {};
    part_ = Part::prefix;
    const std::span<const std::byte> bytes(body_.get(), collects_ ? prefix_.body_size : 0);
    auto body = bytes.empty() ? Body() : Body(bytes, std::exchange(body_, nullptr));
    return protocol::make_packet(prefix_.type, std::exchange(header_, {}), prefix_.channel, std::move(body));
}

/// Refuses another protocol by its first bytes, before a whole prefix has arrived.
void PacketReader::require_hive() const
{
    const auto* at = buffer_.get() + begin_;
    const auto bytes = end_ - begin_;
    if (std::memcmp(at, protocol::magic.data(), std::min(bytes, protocol::magic.size())) == 0)
        return;
    // The records with which TLS begins: a handshake, or an alert. The verdict must not depend on how the bytes are
    // split.
    const bool may_be_tls = first_ && (at[0] == 0x16 || at[0] == 0x15);
    if (may_be_tls && bytes < 2)
        return;
    if (may_be_tls && at[1] == 0x03)
        throw Error(Errc::not_permitted, "it uses TLS, which needs a swarm key, and this end has no key",
                    "both ends need the same key: hivectl key show");
    throw Error(Errc::malformed, "not a Hive packet: it does not start with HIVE");
}

bool PacketReader::take_prefix(const Judge& wants_body)
{
    const auto bytes = end_ - begin_;
    if (bytes < protocol::prefix_size) {
        if (by_first_bytes_)
            require_hive();
        return false;
    }
    if (first_)
        require_hive();
    prefix_ = protocol::decode_prefix(buffer_.get() + begin_, limits_);
    require_in_place();
    const bool wanted = !wants_body || wants_body(prefix_);
    collects_ = (wanted && carries_body(prefix_.type)) || !judges_;
    begin_ += protocol::prefix_size;
    header_.reserve(prefix_.header_size);
    part_ = Part::header;
    return true;
}

void PacketReader::require_in_place()
{
    const bool first = std::exchange(first_, false);
    const bool hello = prefix_.type == protocol::PacketType::hello;
    if (first && !hello)
        throw Error(Errc::malformed, "the first packet must be a hello, not a " + std::string(token(prefix_.type)));
    if (!first && hello)
        throw Error(Errc::malformed, "a second hello");
}

bool PacketReader::take_header()
{
    const auto bytes = std::min<std::size_t>(end_ - begin_, prefix_.header_size - header_.size());
    header_.append(reinterpret_cast<const char*>(buffer_.get() + begin_), bytes);
    begin_ += bytes;
    if (header_.size() < prefix_.header_size)
        return false;
    begin_body();
    return true;
}

void PacketReader::begin_body()
{
    part_ = Part::body;
    body_filled_ = 0;
    if (prefix_.body_size == 0 || !collects_)
        return;
    try {
        // Not zero-filled: pages that the peer does not fill are never touched, so its number alone costs no memory.
        body_ = touches_no_pages_ ? std::make_unique_for_overwrite<std::byte[]>(prefix_.body_size)
                                  : std::make_unique<std::byte[]>(prefix_.body_size);
    } catch (const std::bad_alloc&) {
        throw Error(Errc::too_large, "no memory for a body of " + std::to_string(prefix_.body_size) + " bytes");
    }
}

bool PacketReader::take_body()
{
    const auto bytes = std::min<std::size_t>(end_ - begin_, prefix_.body_size - body_filled_);
    if (bytes != 0 && collects_)
        std::memcpy(body_.get() + body_filled_, buffer_.get() + begin_, bytes);
    begin_ += bytes;
    body_filled_ += bytes;
    return body_filled_ == prefix_.body_size;
}

std::string PacketReader::progress() const
{
    const auto text = [](std::size_t have, std::size_t all, const char* part) {
        return std::to_string(have) + " of " + std::to_string(all) + " bytes of its " + part;
    };
    switch (part_) {
    case Part::prefix: return text(end_ - begin_, protocol::prefix_size, "prefix");
    case Part::header: return text(header_.size(), prefix_.header_size, "header");
    case Part::body: break;
    }
    return text(body_filled_, prefix_.body_size, "body");
}

}  // namespace hive::transport
