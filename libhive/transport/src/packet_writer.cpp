// Batches the packets of two lanes.
#include "packet_writer.hpp"

#include <algorithm>
#include <iterator>

namespace hive::transport {
namespace {

constexpr std::size_t batch_packets = 16;
constexpr std::size_t batch_bytes = 64 * 1024;

bool in_event_lane(protocol::PacketType type)
{
    using enum protocol::PacketType;
    return type == event || type == reference || type == notification || type == exception || type == end
           || type == put;
}

}  // namespace

void PacketWriter::push(protocol::Packet packet, Written written, int descriptor)
{
    const bool is_event = in_event_lane(packet.type);
    const auto size = packet.size();
    const auto prefix = encode(packet.prefix());
    (is_event ? events_ : control_).push_back({std::move(packet), prefix, std::move(written), is_event, descriptor});
    if (!is_event)
        control_bytes_ += size;
}

std::span<const asio::const_buffer> PacketWriter::gather()
{
    fill_batch();
    list_buffers();
    return buffers_;
}

void PacketWriter::fill_batch()
{
    std::size_t bytes = batch_.empty() ? 0 : batch_.front().packet.size() - begun_;
    while (batch_.size() < batch_packets && bytes < batch_bytes) {
        auto& lane = control_.empty() ? events_ : control_;
        if (lane.empty() || (lane.front().descriptor >= 0 && !batch_.empty()))
            return;
        bytes += lane.front().packet.size();
        batch_.push_back(std::move(lane.front()));
        lane.pop_front();
    }
}

void PacketWriter::list_buffers()
{
    buffers_.clear();
    std::size_t skip = begun_;
    const auto add = [&](const void* at, std::size_t size) {
        const auto skipped = std::min(skip, size);
        skip -= skipped;
        if (size > skipped)
            buffers_.emplace_back(static_cast<const unsigned char*>(at) + skipped, size - skipped);
    };
    for (const auto& item : batch_) {
        add(item.prefix.data(), item.prefix.size());
        add(item.packet.header_text().data(), item.packet.header_text().size());
        add(item.packet.body.data(), item.packet.body.size());
    }
}

std::vector<PacketWriter::Written> PacketWriter::wrote(std::size_t bytes)
{
    std::vector<Written> callbacks;
    begun_ += bytes;
    auto item = batch_.begin();
    for (; item != batch_.end() && begun_ >= item->packet.size(); ++item) {
        begun_ -= item->packet.size();
        finish(*item, callbacks);
    }
    batch_.erase(batch_.begin(), item);
    put_back();
    return callbacks;
}

void PacketWriter::finish(Item& item, std::vector<Written>& callbacks)
{
    if (!item.is_event)
        control_bytes_ -= item.packet.size();
    if (item.written)
        callbacks.push_back(std::move(item.written));
}

// Returns packets that have not begun to their lanes, so that a new control packet overtakes the events among them.
void PacketWriter::put_back()
{
    const std::size_t keep = begun_ > 0 ? 1 : 0;
    while (batch_.size() > keep) {
        auto& item = batch_.back();
        (item.is_event ? events_ : control_).push_front(std::move(item));
        batch_.pop_back();
    }
}

std::vector<PacketWriter::Written> PacketWriter::drop()
{
    std::vector<Written> callbacks;
    for (auto& item : batch_)
        finish(item, callbacks);
    for (auto* lane : {&control_, &events_})
        for (auto& item : *lane)
            finish(item, callbacks);
    batch_.clear();
    control_.clear();
    events_.clear();
    begun_ = 0;
    return callbacks;
}

}  // namespace hive::transport
