// One plain receiver, and a transport that writes at once.
#pragma once

#include "fixtures.hpp"

namespace hive::event {

struct OneLine {
    explicit OneLine(const ConnectionOptions& with) : options(with), line(1, "face.image", epoch, with, ledger) {}

    Sequences offer(std::int64_t sequence, bool lossless = false)
    {
        return deliver(decided([&](Decisions& to) { line.offer(emission(sequence, lossless), now, to); }));
    }
    Sequences ask(std::int64_t asked, std::int64_t done = 0) { return ask(Progress{asked, done, done}); }
    Sequences ask(const Progress& progress)
    {
        return deliver(decided([&](Decisions& to) { line.request(registration, progress, to); }));
    }
    /// It comes back with what it has had, or as a new process.
    Sequences resume(std::optional<std::int64_t> taken)
    {
        return deliver(decided([&](Decisions& to) {
            behind = line.resume(1, ++registration, options, taken, to);
            line.pump(to);
        }));
    }
    Sequences deliver(const Decisions& decisions)
    {
        Sequences all = sequences(decisions);
        for (const auto& send : decisions.sends)
            told.push_back(send.share);
        for (const auto& event : decisions.failed)
            failed.push_back(event);
        for (const auto& send : decisions.sends) {
            const auto more = deliver(decided([&](Decisions& to) { line.written(send.event->size(), to); }));
            all.insert(all.end(), more.begin(), more.end());
        }
        return all;
    }

    ConnectionOptions options;
    Ledger ledger;
    Clock::time_point now{};
    std::int64_t registration = epoch;
    Line line;
    std::int64_t behind = 0;                 ///< where its deliveries go on after resume()
    std::vector<std::optional<Share>> told;  ///< with each delivery
    std::vector<EmissionPtr> failed;
};

}  // namespace hive::event
