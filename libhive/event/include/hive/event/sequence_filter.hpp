// Refuses second answers to shared work: an attempt that was given up may still answer after another one did.
#pragma once

#include <hive/event.hpp>

#include <deque>
#include <set>
#include <string>
#include <tuple>

namespace hive::event {

/// Remembers the last answers that came to one input. Pure logic, for one thread.
class SequenceFilter {
public:
    static constexpr std::size_t remembered = 65536;

    /// True the first time that this answer comes; always true for events that are not from shared work.
    bool first(const Event& event);

private:
    using Key = std::tuple<std::string, std::int64_t, std::int64_t, std::int64_t, std::string, int>;
    std::set<Key> seen_;
    std::deque<Key> order_;
};

}  // namespace hive::event
