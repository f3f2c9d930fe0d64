// Waiting lines by source and epoch.
#include "reorder.hpp"

#include <algorithm>

namespace hive {

void Reorder::push(Event event, TimePoint now)
{
    if (event.identity.group.empty() && !event.identity.lossless) {
        ready_.push_back(std::move(event));  // live and not shared: its gaps are skips, nothing is to be waited for
        return;
    }
    Line& line = lines_[key_of(event.identity)];
    line.lossless = event.identity.lossless;
    const auto sequence = number_of(event.identity);
    if (line.expected == 0) {
        line.expected = line.lossless ? 1 : sequence;
        line.stuck_since = now;
    }
    if (line.passed(sequence))
        return;
    const std::pair key{sequence, event.identity.part};
    line.waiting.emplace(key, std::move(event));
    advance(line, now);
}

void Reorder::fail(const Identity& identity, TimePoint now)
{
    Line& line = lines_[key_of(identity)];
    if (number_of(identity) >= line.expected && line.failed.insert(number_of(identity)).second)
        ++failed_;
    advance(line, now);
}

void Reorder::advance(Line& line, TimePoint now)
{
    if (line.expected == 0)
        return;
    for (bool moved = true; moved;) {
        moved = line.failed.erase(line.expected) > 0;
        if (moved)
            ++line.expected;
        // A sequence already handed out may have further parts: they follow as they come.
        while (!line.waiting.empty() && line.waiting.begin()->first.first <= line.expected) {
            const auto sequence = line.waiting.begin()->first.first;
            if (line.first == 0)
                line.first = sequence;
            line.expected = std::max(line.expected, sequence + 1);
            ready_.push_back(std::move(line.waiting.begin()->second));
            line.waiting.erase(line.waiting.begin());
            moved = true;
        }
        if (moved)
            line.stuck_since = now;
    }
    if (!line.lossless && line.waiting.size() > live_window)
        line.stuck_since = TimePoint::min();
}

std::chrono::milliseconds Reorder::patience_of(const Line& line) const
{
    if (line.first == 0)
        return std::min(patience_, first_patience);
    return line.lossless ? patience_ : std::min(patience_, live_patience);
}

void Reorder::expire(TimePoint now)
{
    for (auto& [key, line] : lines_)
        while (!line.waiting.empty()
               && (line.stuck_since == TimePoint::min() || now - line.stuck_since >= patience_of(line))) {
            const auto next = line.waiting.begin()->first.first;
            if (line.first != 0)
                give_up(line, next);
            line.expected = next;
            advance(line, now);
        }
}

void Reorder::give_up(Line& line, std::int64_t next)
{
    missing_ += next - line.expected;
    line.given_up[line.expected] = next;
    if (line.given_up.size() > remembered_gaps)
        line.given_up.erase(line.given_up.begin());
}

bool Reorder::Line::passed(std::int64_t sequence) const
{
    const auto after = given_up.upper_bound(sequence);
    return sequence < first || (after != given_up.begin() && sequence < std::prev(after)->second);
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
    for (const auto& [key, line] : lines_)
        if (!line.waiting.empty()) {
            const auto due =
                line.stuck_since == TimePoint::min() ? line.stuck_since : line.stuck_since + patience_of(line);
            first = first ? std::min(*first, due) : due;
        }
    return first;
}

}  // namespace hive
