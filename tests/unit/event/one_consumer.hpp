// A subscription that is not shared, and a transport that writes at once.
#pragma once

#include "fixtures.hpp"

namespace hive::event {

struct OneConsumer {
    explicit OneConsumer(const ConnectionOptions& with, bool passive = false)
        : options(with), subscription({.passive = passive || with.delivery != Delivery::data})
    {
        deliver(decided([&](Decisions& to) { subscription.attach(1, options, {}, nullptr, now, to); }));
    }

    Sequences offer(std::int64_t sequence, bool lossless = false) { return offer(emission(sequence, lossless)); }
    Sequences offer(const EmissionPtr& event)
    {
        return deliver(decided([&](Decisions& to) { subscription.offer(event, now, to); }));
    }
    Sequences ask(std::int64_t asked, std::int64_t done = 0) { return ask(Progress{asked, done, done}); }
    Sequences ask(const Progress& progress)
    {
        return deliver(decided([&](Decisions& to) { subscription.request(1, progress, {}, now, to); }));
    }
    /// @return  whether its source waits for it
    bool lose(Fate how, bool returns = true)
    {
        deliver(
            decided([&](Decisions& to) { subscription.detach(1, how, returns && how != Fate::lost_left, now, to); }));
        return subscription.awaited();
    }
    /// It comes back with what it has had, or as a new process.
    Sequences resume(std::optional<std::int64_t> received, std::int64_t held = 0)
    {
        return deliver(decided([&](Decisions& to) {
            behind = subscription.attach(1, options, {received, held}, nullptr, now, to);
        }));
    }
    Sequences pass(Clock::duration time)
    {
        now += time;
        return deliver(decided([&](Decisions& to) { subscription.tick(now, to); }));
    }
    Sequences deliver(const Decisions& decisions)
    {
        Sequences all = sequences(decisions);
        for (const auto& send : decisions.sends)
            told.push_back(send.share);
        for (const auto& event : decisions.failed)
            failed.push_back(event);
        if (!stalled)
            for (const auto& send : decisions.sends) {
                const auto more = written(send.event->size());
                all.insert(all.end(), more.begin(), more.end());
            }
        return all;
    }
    Sequences written(std::size_t bytes)
    {
        return deliver(decided([&](Decisions& to) { subscription.written(1, bytes, now, to); }));
    }
    [[nodiscard]] const Ledger& ledger() const { return subscription.ledger(); }

    ConnectionOptions options;
    bool stalled = false;  ///< the transport writes nothing by itself
    Clock::time_point now = start;
    Subscription subscription;
    std::int64_t behind = 0;                 ///< where its deliveries continue after resume()
    std::vector<std::optional<Share>> told;  ///< with each delivery
    std::vector<EmissionPtr> failed;
};

}  // namespace hive::event
