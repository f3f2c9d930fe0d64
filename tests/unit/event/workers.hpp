// Workers that share a subscription, and a transport that writes at once.
#pragma once

#include "fixtures.hpp"

#include <map>

namespace hive::event {

using Got = std::map<ReceiverId, Sequences>;

class Workers {
public:
    explicit Workers(int count, const ConnectionOptions& options = sharing(), bool leases = true)
        : subscription({.shared_as = "camera.image#workers", .epoch = 1, .redelivers = leases}), options_(options)
    {
        for (int id = 1; id <= count; ++id)
            join(static_cast<ReceiverId>(id));
    }

    Got join(ReceiverId id) { return join(id, "face-" + std::to_string(id)); }
    Got join(ReceiverId id, const std::string& name) { return join(id, name, options_); }
    Got join(ReceiverId id, const std::string& name, const ConnectionOptions& options)
    {
        members[name].local = true;
        return got([&](Decisions& to) { subscription.attach(id, options, {}, &members[name], now, to); });
    }
    /// It comes back, and has this many deliveries.
    Got resume(ReceiverId id, const std::string& name, std::int64_t received, std::int64_t held)
    {
        return got([&](Decisions& to) {
            subscription.attach(id, options_, {received, held}, &members[name], now, to);
        });
    }
    Got offer(std::int64_t sequence, bool lossless = true)
    {
        return got([&](Decisions& to) { subscription.offer(emission(sequence, lossless), now, to); });
    }
    /// It has dealt with its first `count` deliveries, and asks for `size` more.
    Got done(ReceiverId id, std::int64_t count, int size = 1) { return ask(id, {count + size, count, count}); }
    Got ask(ReceiverId id, const Progress& progress, const std::vector<std::int64_t>& back = {})
    {
        return got([&](Decisions& to) { subscription.request(id, progress, back, now, to); });
    }
    Got leave(ReceiverId id)
    {
        return got([&](Decisions& to) { subscription.detach(id, Fate::lost_left, false, now, to); });
    }
    Got lose(ReceiverId id, Fate how = Fate::lost_killed)
    {
        return got([&](Decisions& to) { subscription.detach(id, how, true, now, to); });
    }
    Got forget()
    {
        return got([&](Decisions& to) { subscription.cancel(to); });
    }
    /// This member, which lost its connection, will not return.
    Got forget(const std::string& name)
    {
        return got([&](Decisions& to) { subscription.forget_away(members[name], now, to); });
    }
    /// No member will come.
    Got give_up()
    {
        return got([&](Decisions& to) { subscription.give_up(to); });
    }
    Got pass(Clock::duration time)
    {
        now += time;
        return got([&](Decisions& to) { subscription.tick(now, to); });
    }
    [[nodiscard]] std::int64_t went(Fate fate) const { return ledger().of(fate); }
    [[nodiscard]] bool all_balanced() const
    {
        for (const auto& [name, member] : members)
            if (!balanced(member.ledger))
                return false;
        return balanced(ledger());
    }

    [[nodiscard]] const Ledger& ledger() const { return subscription.ledger(); }

    std::map<std::string, Subscription::Member> members;
    Subscription subscription;
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
                decided([&](Decisions& to) { subscription.written(send.receiver, send.event->size(), now, to); });
            for (const auto& [id, more] : deliver(freed))
                result[id].insert(result[id].end(), more.begin(), more.end());
        }
        return result;
    }

    ConnectionOptions options_;
};

}  // namespace hive::event
