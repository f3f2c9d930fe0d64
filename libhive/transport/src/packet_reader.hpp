// Assembles packets from the bytes of a stream. No socket, no clock.
#pragma once

#include <hive/protocol/packet.hpp>

#include <asio/buffer.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace hive::transport {

/// Prefixes, headers and small bodies come through one small buffer, so that many small packets cost one read. The rest
/// of a body is read directly into its final buffer. The first packet must be a hello within protocol::hello_limits.
class PacketReader {
public:
    PacketReader();

    /// The buffer for the next bytes; never empty once next() has returned nothing. Inside a body: all its missing
    /// bytes.
    asio::mutable_buffer space();
    /// This many bytes have been written there.
    void received(std::size_t bytes);
    /// Judges a packet by its prefix: false skips its body, which is neither stored nor passed on. May throw.
    using Judge = std::function<bool(const protocol::Prefix&)>;
    /// The next complete packet. Throws Errc::malformed, version_mismatch and too_large, and what `wants_body` throws,
    /// before allocating. Skips the body of a type without body.
    std::optional<protocol::Packet> next(const Judge& wants_body = {});
    /// The limits after the first packet.
    void open(const protocol::Limits& limits) { limits_ = limits; }
    /// A packet has begun and is incomplete. Meaningful once next() has returned nothing.
    [[nodiscard]] bool inside() const { return part_ != Part::prefix || begin_ != end_; }
    /// The progress of the packet: "12 of 16 bytes of its prefix".
    [[nodiscard]] std::string progress() const;

private:
    enum class Part { prefix, header, body };
    bool take_prefix(const Judge& wants_body);
    void require_hive() const;
    void require_in_place();
    bool take_header();
    bool take_body();
    void begin_body();
    /// The next bytes go directly into the body.
    [[nodiscard]] bool reads_into_body() const { return part_ == Part::body && begin_ == end_ && collects_; }

    static constexpr std::size_t buffer_size = 16 * 1024;
    std::unique_ptr<unsigned char[]> buffer_;  ///< [begin_, end_) has arrived and is not parsed yet
    std::size_t begin_ = 0, end_ = 0;
    protocol::Limits limits_ = protocol::hello_limits;
    const bool by_first_bytes_, touches_no_pages_, judges_;  ///< false only in twins of tests
    bool first_ = true;
    Part part_ = Part::prefix;
    protocol::Prefix prefix_;
    bool collects_ = false;  ///< stores the body of this packet
    std::string header_;
    std::shared_ptr<std::byte[]> body_;
    std::size_t body_filled_ = 0;
};

}  // namespace hive::transport
