// Events for the tests of the event layer.
#pragma once

#include <hive/event/receiver_table.hpp>

namespace hive::event {

inline EmissionPtr emission(std::int64_t sequence, bool lossless = false, std::size_t bytes = 10)
{
    Event event;
    event.identity = {.source = "camera", .epoch = 1, .sequence = sequence, .lossless = lossless, .hops = {}};
    event.sender = "camera";
    event.kind = "camera";
    event.output = "image";
    event.type = "image/jpeg";
    event.body = Body(std::vector<unsigned char>(bytes, 7));
    return std::make_shared<const Emission>(std::move(event));
}

inline std::vector<std::int64_t> sequences(const ReceiverTable::Decisions& decisions)
{
    std::vector<std::int64_t> result;
    for (const auto& send : decisions.sends)
        result.push_back(send.event->event().identity.sequence);
    return result;
}

inline ConnectionOptions window(int size)
{
    ConnectionOptions options;
    options.window = size;
    return options;
}

inline ConnectionOptions streaming(Delivery delivery = Delivery::data)
{
    ConnectionOptions options;
    options.transfer = Transfer::streaming;
    options.delivery = delivery;
    return options;
}

inline ConnectionOptions sharing(int size = 1)
{
    ConnectionOptions options = window(size);
    options.group = "workers";
    return options;
}

using Sequences = std::vector<std::int64_t>;
inline const Clock::time_point start{};
constexpr std::int64_t epoch = 5;

/// The books balance: nothing vanishes uncounted.
inline bool balanced(const Counts& counts)
{
    return counts.produced == counts.delivered + counts.skipped + counts.dropped + counts.abandoned + counts.in_flight;
}

}  // namespace hive::event
