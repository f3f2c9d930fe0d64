// Events, options and small worlds for the tests of the event layer.
#pragma once

#include <hive/event/receiver_table.hpp>

namespace hive::event {

/// @param lossless  it also has its output's share, as the emitter gives it one
inline EmissionPtr emission(std::int64_t sequence, bool lossless = false, std::size_t bytes = 10)
{
    Event event;
    event.identity = {.source = "camera", .epoch = 1, .sequence = sequence, .lossless = lossless};
    event.sender = "camera";
    event.kind = "camera";
    event.output = "image";
    event.type = "image/jpeg";
    event.body = Body(std::vector<unsigned char>(bytes, 7));
    std::optional<Share> own;
    if (lossless)
        own = Share{.of = "camera.image", .epoch = 1, .turn = sequence};
    return std::make_shared<const Emission>(std::move(event), true, own);
}

inline std::int64_t sequence_of(const EmissionPtr& event) { return event->event().identity.sequence; }

using Sequences = std::vector<std::int64_t>;

inline Sequences sequences(const Decisions& decisions)
{
    Sequences result;
    for (const auto& send : decisions.sends)
        result.push_back(sequence_of(send.event));
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

inline ConnectionOptions sharing(std::chrono::milliseconds lease, int size = 1)
{
    ConnectionOptions options = sharing(size);
    options.lease = lease;
    return options;
}

inline const Clock::time_point start{};
constexpr std::int64_t epoch = 5;

/// What a call decides that writes its decisions into its argument.
template <class Call>
Decisions decided(Call call)
{
    Decisions decisions;
    call(decisions);
    return decisions;
}

/// Nothing vanishes uncounted.
inline bool balanced(const Ledger& ledger)
{
    std::int64_t gone = 0;
    for (std::size_t fate = 0; fate < fates; ++fate)
        gone += ledger.of(static_cast<Fate>(fate));
    return ledger.in_flight() >= 0 && ledger.total() == gone + ledger.in_flight();
}

}  // namespace hive::event
