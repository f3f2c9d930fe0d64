// A receiver table, and a transport that writes at once.
#pragma once

#include "fixtures.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace hive::event {

using Got = std::map<ReceiverId, Sequences>;

class World {
public:
    explicit World(ReceiverTable::Defences defences = {true, true}) : table("camera.image", 1, defences) {}

    Got add(ReceiverId id, const std::string& receiver, const ConnectionOptions& options)
    {
        return add({.id = id, .receiver = receiver, .options = options});
    }
    Got add(Newcomer newcomer)
    {
        newcomer.epoch = registrations[newcomer.id] = ++last_registration;
        return got([&](Decisions& to) { welcome = table.add(newcomer, now, to); });
    }
    Got leave(ReceiverId id)
    {
        return got([&](Decisions& to) { table.leave(id, now, to); });
    }
    Got lose(ReceiverId id, Fate how, bool returns = true)
    {
        return got([&](Decisions& to) { table.lose(id, how, returns, now, to); });
    }
    Got offer(std::int64_t sequence, bool lossless = false, bool hold = false)
    {
        return offer(emission(sequence, lossless), hold);
    }
    Got offer(EmissionPtr event, bool hold = false)
    {
        Decisions decisions;
        table.offer(event, hold, now, decisions);
        event.reset();
        return deliver(std::move(decisions));
    }
    Got ask(ReceiverId id, const Progress& progress, const std::vector<std::int64_t>& back = {})
    {
        return got([&](Decisions& to) { table.request(id, registrations[id], progress, back, now, to); });
    }
    Got pass(Clock::duration time)
    {
        now += time;
        return got([&](Decisions& to) { table.tick(now, to); });
    }
    std::size_t forget(const std::string& drone)
    {
        std::size_t forgotten = 0;
        got([&](Decisions& to) { forgotten = table.forget(drone, to); });
        return forgotten;
    }

    /// Who stands at a place of "results".
    [[nodiscard]] std::optional<ReceiverId> standing(std::int64_t place) const
    {
        return table.standing({.receiver = "results", .place = place});
    }
    [[nodiscard]] std::vector<EdgeStatus> rows() const
    {
        std::vector<EdgeStatus> rows;
        for (const auto& row : table.rows())
            rows.push_back(row.status);
        return rows;
    }
    [[nodiscard]] bool has_row(const std::string& receiver) const
    {
        return std::ranges::count(rows(), receiver, &EdgeStatus::receiver) == 1;
    }
    [[nodiscard]] EdgeStatus row(const std::string& receiver) const
    {
        for (auto& row : rows())
            if (row.receiver == receiver)
                return row;
        return {};
    }

    ReceiverTable table;
    Clock::time_point now = start;
    Welcome welcome;
    Sequences failed;
    std::optional<Share> last_share;
    std::int64_t last_registration = epoch;
    std::map<ReceiverId, std::int64_t> registrations;

private:
    /// Receiver -> sequences it got, with what writing set free. The events themselves are let go.
    template <class Call>
    Got got(Call call)
    {
        return deliver(decided(call));
    }
    Got deliver(Decisions decisions)
    {
        Got result;
        std::vector<std::pair<ReceiverId, std::size_t>> sent;
        for (const auto& send : std::exchange(decisions.sends, {})) {
            result[send.receiver].push_back(sequence_of(send.event));
            last_share = send.share;
            sent.emplace_back(send.receiver, send.event->size());
        }
        for (const auto& event : std::exchange(decisions.failed, {}))
            failed.push_back(sequence_of(event));
        for (const auto& [receiver, bytes] : sent) {
            Decisions freed;
            table.written(receiver, bytes, now, freed);
            for (const auto& [id, more] : deliver(std::move(freed)))
                result[id].insert(result[id].end(), more.begin(), more.end());
        }
        return result;
    }
};

}  // namespace hive::event
