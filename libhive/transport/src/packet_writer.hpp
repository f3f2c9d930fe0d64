// Turns packets into gather lists: two lanes, of which control overtakes events at packet boundaries. No socket, no
// clock.
#pragma once

#include <hive/protocol/packet.hpp>
#include <hive/transport/connection.hpp>

#include <asio/buffer.hpp>

#include <deque>
#include <span>
#include <vector>

namespace hive::transport {

/// Holds packets until their last byte is written; copies no body.
class PacketWriter {
public:
    using Written = Connection::Written;

    /// @param descriptor  sent with its first byte; -1: none
    void push(protocol::Packet packet, Written written, int descriptor = -1);
    /// The next bytes to write: the rest of a packet that has begun, then waiting control packets, then events, until
    /// there are 16 packets or 64 KiB; a packet with a descriptor begins a list of its own. Valid until wrote() or
    /// drop(). Empty if nothing waits.
    std::span<const asio::const_buffer> gather();
    /// The descriptor to send with the first byte of the gather list; -1: none.
    [[nodiscard]] int descriptor() const { return batch_.empty() || begun_ > 0 ? -1 : batch_.front().descriptor; }
    /// This many bytes of the gather list are written. Returns the callbacks of completed packets, in order.
    std::vector<Written> wrote(std::size_t bytes);
    /// Drops everything. Returns the callbacks of packets that were not completely written.
    std::vector<Written> drop();

    [[nodiscard]] bool idle() const { return batch_.empty() && control_.empty() && events_.empty(); }
    [[nodiscard]] std::size_t control_bytes() const { return control_bytes_; }

private:
    struct Item {
        protocol::Packet packet;
        protocol::PrefixBytes prefix;
        Written written;
        bool is_event;
        int descriptor;
    };
    void fill_batch();
    void list_buffers();
    void finish(Item& item, std::vector<Written>& callbacks);
    void put_back();

    std::deque<Item> control_, events_;
    std::vector<Item> batch_;  ///< being written; between writes at most one packet, of which `begun_` bytes are sent
    std::size_t begun_ = 0;
    std::vector<asio::const_buffer> buffers_;
    std::size_t control_bytes_ = 0;  ///< of control packets not completely written
};

}  // namespace hive::transport
