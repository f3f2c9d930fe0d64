// Bytes in, packets out: where the next bytes of a stream belong and when a packet is whole. No socket, no clock.
#pragma once

#include <hive/protocol/packet.hpp>

#include <asio/buffer.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace hive::transport {

/// Prefixes, headers and small bodies come through one small buffer, so that many small packets cost one read. The rest
/// of a body is read straight to where it stays. The first packet must be a hello within protocol::hello_limits.
class PacketReader {
public:
    PacketReader();

    /// Where the next bytes go; never empty once next() has returned nothing. Inside a body: all of it that is missing.
    asio::mutable_buffer space();
    /// So many bytes have been put there.
    void received(std::size_t bytes);
    /// Judges a packet by its prefix: false passes over its body, which is neither collected nor handed over. May
    /// throw.
    using Judge = std::function<bool(const protocol::Prefix&)>;
    /// The next packet when it is whole. Throws Errc::malformed, version_mismatch and too_large, and what `wants_body`
    /// throws, before allocating. Of a type that has no body a body is passed over.
    std::optional<protocol::Packet> next(const Judge& wants_body = {});
    /// What holds after the first packet.
    void open(const protocol::Limits& limits) { limits_ = limits; }
    /// A packet has begun and is not whole. Meaningful once next() has returned nothing.
    [[nodiscard]] bool inside() const { return part_ != Part::prefix || begin_ != end_; }
    /// How far the packet has come: "12 of 16 bytes of its prefix".
    [[nodiscard]] std::string progress() const;

private:
    enum class Part { prefix, header, body };
    bool take_prefix(const Judge& wants_body);
    void require_hive() const;
    void require_in_place();
    bool take_header();
    bool take_body();
    void begin_body();
    /// The next bytes go to where the body stays.
    [[nodiscard]] bool reads_into_body() const { return part_ == Part::body && begin_ == end_ && collects_; }

    static constexpr std::size_t buffer_size = 16 * 1024;
    std::unique_ptr<unsigned char[]> buffer_;  ///< [begin_, end_) has come and is not used yet
    std::size_t begin_ = 0, end_ = 0;
    protocol::Limits limits_ = protocol::hello_limits;
    const bool by_first_bytes_, touches_no_pages_, judges_;  ///< false in twins of tests alone
    bool first_ = true;
    Part part_ = Part::prefix;
    protocol::Prefix prefix_;
    bool collects_ = false;  ///< the body of this packet
    std::string header_;
    std::shared_ptr<std::byte[]> body_;
    std::size_t body_filled_ = 0;
};

}  // namespace hive::transport
