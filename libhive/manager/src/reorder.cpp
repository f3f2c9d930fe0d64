// Keeps a queue per group and epoch.
#include "reorder.hpp"

#include <algorithm>

namespace hive {

void Reorder::expect(const Share& standing, const std::vector<std::int64_t>& open)
{
    Line& line = lines_[key_of(standing)];
    line.closed = std::max(line.closed, standing.closed);
    line.joined = std::max(line.joined, standing.turn);
    line.open.insert(open.begin(), open.end());
}

bool Reorder::push(Event event, TimePoint now)
{
    const Share* share = event.identity.shared_work();
    if (!share) {
        ready_.push_back(std::move(event));
        return true;
    }
    if (const Line* later = later_run(key_of(*share), event.identity)) {
        const auto& reached = later->reached;
        if (reached && std::get<0>(*reached) == event.identity.source && capture_of(event) <= *reached) {
            if (event.identity.lossless)
                ready_.push_back(std::move(event));
            return event.identity.lossless;
        }
        earlier_.emplace(capture_of(event), Earlier{event, now});
        return true;
    }
    end_earlier_runs(key_of(*share), event.identity, now);
    Line& line = lines_[key_of(*share)];
    if (line.sources.size() < max_sources || line.sources.contains(event.identity.source))
        line.sources[event.identity.source] = event.identity.epoch;
    line.lossless = event.identity.lossless;
    line.finished = finished_ = false;
    line.closed = std::max(line.closed, share->closed);
    if (line.first == 0) {
        line.first = line.expected = std::min(line.closed + 1, share->turn);
        line.stuck_since = now;
    }
    if (line.unanswered.erase(share->turn) > 0)
        miss(key_of(*share), share->turn);
    if (share->turn < line.first || line.passed.contains(share->turn) || line.failed.contains(share->turn))
        return false;
    if (line.waiting.empty())
        line.stuck_since = now;  // until now nothing waited for an earlier result
    line.waiting.emplace(share->turn, std::move(event));
    advance(line, now);
    return true;
}

bool Reorder::Line::has(const Identity& identity) const
{
    const auto run = sources.find(identity.source);
    return run != sources.end() && run->second == identity.epoch;
}

const Reorder::Line* Reorder::later_run(const Key& key, const Identity& identity) const
{
    for (auto it = lines_.upper_bound(key); it != lines_.end() && it->first.first == key.first; ++it)
        if (it->second.has(identity))
            return &it->second;
    return nullptr;
}

void Reorder::end_earlier_runs(const Key& key, const Identity& identity, TimePoint now)
{
    for (auto it = lines_.lower_bound({key.first, 0}); it != lines_.end() && it->first < key;) {
        if (!it->second.has(identity)) {
            ++it;
            continue;
        }
        for (auto& [turn, event] : it->second.waiting)
            earlier_.emplace(capture_of(event), Earlier{event, now});
        it = lines_.erase(it);
    }
}

void Reorder::hand_out(Line& line, Event event)
{
    const auto capture = capture_of(event);
    const Capture first{event.identity.source, event.identity.epoch, 0};
    for (auto it = earlier_.lower_bound(first); it != earlier_.end() && it->first < capture; it = earlier_.erase(it))
        ready_.push_back(std::move(it->second.event));
    line.reached = capture;
    ready_.push_back(std::move(event));
}

void Reorder::skip(const Identity& identity, TimePoint now)
{
    const Share* share = identity.shared_work();
    if (!share || later_run(key_of(*share), identity))
        return;
    Line& line = lines_[key_of(*share)];
    if (share->turn < line.expected || line.waiting.contains(share->turn))
        return;
    line.skipped.insert(share->turn);
    advance(line, now);
}

void Reorder::fail(const Identity& identity, TimePoint now)
{
    const Share* share = identity.shared_work();
    if (!share || later_run(key_of(*share), identity)) {
        ++failed_;
        return;
    }
    Line& line = lines_[key_of(*share)];
    line.closed = std::max(line.closed, share->closed);
    const bool answered = share->turn < line.expected || line.waiting.contains(share->turn);
    if (answered || !line.failed.insert(share->turn).second)
        return;
    ++failed_;
    advance(line, now);
}

void Reorder::advance(Line& line, TimePoint now)
{
    const auto before = line.expected;
    for (bool moved = line.first != 0; moved;) {
        moved = line.failed.contains(line.expected) || line.skipped.erase(line.expected) > 0;
        if (moved)
            ++line.expected;
        // A turn already handed out may have further results: they follow as they come.
        while (!line.waiting.empty() && line.waiting.begin()->first <= line.expected) {
            line.expected = std::max(line.expected, line.waiting.begin()->first + 1);
            hand_out(line, std::move(line.waiting.begin()->second));
            line.waiting.erase(line.waiting.begin());
            moved = true;
        }
    }
    if (line.expected != before)
        line.stuck_since = now;
    for (auto* turns : {&line.failed, &line.skipped})
        while (turns->size() > remembered_turns)
            turns->erase(turns->begin());
}

/// A turn closes only after its lossless result was acknowledged here. So a closed turn without a result here will have
/// none: its worker made none, or is not a sender here. A worker that left its group while it had no receiver still
/// holds a result: when that arrives it counts as missing, see push().
bool Reorder::answered(const Line& line, std::int64_t turn)
{
    return line.lossless && (turn <= line.closed || line.finished);
}

Reorder::TimePoint Reorder::due(const Line& line) const
{
    if (!line.lossless && line.waiting.size() > live_window)
        return line.stuck_since;
    if (line.lossless && line.expected <= line.closed)
        return line.stuck_since;
    if (!line.lossless && line.expected <= line.joined && !line.open.contains(line.expected))
        return line.stuck_since + std::min(timeout_, join_timeout);
    return line.stuck_since
           + (line.finished || line.expected <= line.closed ? std::min(timeout_, closed_timeout) : timeout_);
}

Reorder::TimePoint Reorder::due(const Earlier& earlier) const
{
    return earlier.since + (finished_ ? std::min(timeout_, closed_timeout) : timeout_);
}

void Reorder::finish(TimePoint now)
{
    if (!std::exchange(finished_, true))
        for (auto& [capture, earlier] : earlier_)
            earlier.since = now;
    for (auto& [key, line] : lines_)
        if (!std::exchange(line.finished, true))
            line.stuck_since = now;  // an exception may still report that there is no result
}

void Reorder::expire(TimePoint now)
{
    for (auto& [key, line] : lines_)
        while (!line.waiting.empty() && due(line) <= now)
            give_up(key, line, now);
    std::erase_if(earlier_, [&](auto& row) {
        const bool hand_out = !behind_waiting(row.first) && due(row.second) <= now;
        if (hand_out)
            ready_.push_back(std::move(row.second.event));
        return hand_out;
    });
}

/// Is a result of an earlier capture of this run waiting? Then this one follows it, see hand_out().
bool Reorder::behind_waiting(const Capture& capture) const
{
    const Capture first{std::get<0>(capture), std::get<1>(capture), 0};
    return std::ranges::any_of(lines_, [&](const auto& row) {
        return std::ranges::any_of(row.second.waiting, [&](const auto& waiting) {
            const auto other = capture_of(waiting.second);
            return first <= other && other < capture;
        });
    });
}

/// Skips the turns that are due. Those from before receiving began do not count as missing.
void Reorder::give_up(const Key& key, Line& line, TimePoint now)
{
    const auto turn = line.expected++;
    line.passed.insert(turn);
    if (answered(line, turn))
        line.unanswered.insert(turn);
    else if (turn > line.joined || line.open.contains(turn))
        miss(key, turn);
    for (auto* turns : {&line.passed, &line.unanswered})
        if (turns->size() > remembered_turns)
            turns->erase(turns->begin());
    const auto since = line.stuck_since;
    advance(line, now);
    if (!line.waiting.empty() && line.expected == turn + 1)
        line.stuck_since = since;  // the next ones have been awaited as long
}

void Reorder::miss(const Key& key, std::int64_t turn)
{
    ++missing_;
    if (auto& turns = missing_turns_[key.first]; turns.size() < remembered_turns)
        turns.push_back(turn);
}

std::optional<Event> Reorder::pop()
{
    if (ready_.empty())
        return std::nullopt;
    Event event = std::move(ready_.front());
    ready_.pop_front();
    return event;
}

std::optional<Reorder::TimePoint> Reorder::deadline() const
{
    std::optional<TimePoint> first;
    for (const auto& [capture, earlier] : earlier_)
        if (!behind_waiting(capture))
            first = std::min(first.value_or(TimePoint::max()), due(earlier));
    for (const auto& [key, line] : lines_)
        if (!line.waiting.empty())
            first = first ? std::min(*first, due(line)) : due(line);
    return first;
}

}  // namespace hive
