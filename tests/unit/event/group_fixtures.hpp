// Workers in one group, and a transport that writes at once.
#pragma once

#include "fixtures.hpp"

#include <map>

namespace hive::event {

using Got = std::map<ReceiverId, Sequences>;

class Workers {
public:
    explicit Workers(int count, const ConnectionOptions& options = sharing(), bool leases = true)
        : group("camera.image#workers", 1, ledger, leases), options_(options)
    {
        for (int id = 1; id <= count; ++id)
            join(static_cast<ReceiverId>(id));
    }

    Got join(ReceiverId id) { return join(id, "face-" + std::to_string(id)); }
    Got join(ReceiverId id, const std::string& name)
    {
        return got([&](Decisions& to) { group.join(id, name, epoch, options_, ledgers[name], now, to); });
    }
    Got offer(std::int64_t sequence, bool lossless = true)
    {
        return got([&](Decisions& to) { group.offer(emission(sequence, lossless), now, to); });
    }
    /// It has dealt with its first `count` deliveries, and asks for `size` more.
    Got done(ReceiverId id, std::int64_t count, int size = 1) { return ask(id, {count + size, count, count}); }
    Got ask(ReceiverId id, const Progress& progress, const std::vector<std::int64_t>& back = {})
    {
        return got([&](Decisions& to) { group.request(id, epoch, progress, back, now, to); });
    }
    Got leave(ReceiverId id)
    {
        return got([&](Decisions& to) { group.leave(id, now, to); });
    }
    Got lose(ReceiverId id, Fate how = Fate::lost_killed)
    {
        return got([&](Decisions& to) { group.lose(id, how, now, to); });
    }
    Got forget()
    {
        return got([&](Decisions& to) { group.forget(to); });
    }
    /// The group ends.
    Got give_up()
    {
        return got([&](Decisions& to) { group.give_up(true, to); });
    }
    Got pass(Clock::duration time)
    {
        now += time;
        return got([&](Decisions& to) { group.tick(now, to); });
    }
    [[nodiscard]] std::int64_t went(Fate fate) const { return ledger.of(fate); }
    [[nodiscard]] bool all_balanced() const
    {
        for (const auto& [name, account] : ledgers)
            if (!balanced(account))
                return false;
        return balanced(ledger);
    }

    Ledger ledger;                          ///< of the group
    std::map<std::string, Ledger> ledgers;  ///< of its members
    Group group;
    Clock::time_point now = start;
    Sequences failed;
    std::optional<Share> last_failed, last_share;

private:
    /// Worker -> sequences it got, with what writing set free.
    template <class Call>
    Got got(Call call)
    {
        return deliver(decided(call));
    }
    Got deliver(const Decisions& decisions)
    {
        Got result;
        for (const auto& send : decisions.sends) {
            result[send.receiver].push_back(sequence_of(send.event));
            last_share = send.share;
        }
        for (const auto& event : decisions.failed) {
            failed.push_back(sequence_of(event));
            last_failed = event->own();
        }
        for (const auto& send : decisions.sends) {
            const auto freed =
                decided([&](Decisions& to) { group.written(send.receiver, send.event->size(), now, to); });
            for (const auto& [id, more] : deliver(freed))
                result[id].insert(result[id].end(), more.begin(), more.end());
        }
        return result;
    }

    ConnectionOptions options_;
};

}  // namespace hive::event
