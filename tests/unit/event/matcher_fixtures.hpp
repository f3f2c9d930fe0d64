// What the tests of the matcher stand on: events to give it, and what becomes of them.
#pragma once

#include <hive/event/matcher.hpp>
#include <hive/event/ticket.hpp>

#include <hive/error.hpp>

#include <doctest/doctest.h>

#include <algorithm>

namespace hive::event::matching {

using namespace std::chrono_literals;
using Sequences = std::vector<std::int64_t>;

inline const Matcher::TimePoint start{};

/// What an event is made of, beside its sequence: a live one of the camera, unless it says otherwise.
struct Made {
    bool lossless = false;
    std::string source = "camera";
    std::int64_t epoch = 1;
    int part = 0;
    std::string sender = {};
    std::string group = {};
    std::size_t bytes = 10;
    std::int64_t captured_us = -1;  ///< -1: 10 ms after the one before
};

inline Event event(const std::string& input, std::int64_t sequence, const Made& made = {})
{
    std::vector<Share> shares;
    if (!made.group.empty())
        shares.push_back({.of = "camera.image#" + made.group, .epoch = 1, .turn = sequence});
    Event event;
    event.identity = {.source = made.source,
                      .epoch = made.epoch,
                      .sequence = sequence,
                      .captured_us = made.captured_us < 0 ? 10'000 * sequence : made.captured_us,
                      .lossless = made.lossless,
                      .part = made.part,
                      .shares = std::move(shares)};
    event.sender = made.sender.empty() ? "sender of " + input : made.sender;
    event.output = "out";
    event.input = input;
    event.body = Body(std::vector<unsigned char>(made.bytes, 7));
    event.ticket = {std::make_shared<Acknowledgement>(), true};
    return event;
}

inline bool is_processing(const std::weak_ptr<Acknowledgement>& ticket)
{
    const auto owed = ticket.lock();
    return owed && owed->processing();
}

/// A matcher that is told the time by the tests, and remembers which events are still being processed.
class Case {
public:
    explicit Case(Match match = Match::exact(), const std::vector<std::string>& inputs = {"image", "marks"})
        : matcher(inputs, match)
    {
    }

    /// Gives events to an input; returns what the sets that became complete are made of.
    std::vector<Sequences> give(const std::string& input, std::initializer_list<std::int64_t> sequences,
                                const Made& made = {})
    {
        for (const auto sequence : sequences) {
            auto fresh = event(input, sequence, made);
            tickets.emplace_back(fresh.ticket.owed());
            matcher.push(std::move(fresh), now);
        }
        return sets();
    }
    std::vector<Sequences> sets()
    {
        std::vector<Sequences> result;
        while (const auto set = matcher.pop()) {
            result.emplace_back();
            for (const auto& each : *set)
                result.back().push_back(each.identity.sequence);
        }
        return result;
    }
    void pass(std::chrono::milliseconds time)
    {
        now += time;
        matcher.expire(now);
    }
    [[nodiscard]] std::int64_t missing(const std::string& input) const
    {
        const auto counts = matcher.counts();
        return counts.missing.contains(input) ? counts.missing.at(input) : 0;
    }
    [[nodiscard]] std::int64_t waiting() const { return matcher.counts().waiting; }
    [[nodiscard]] std::ptrdiff_t held() const { return std::ranges::count_if(tickets, is_processing); }

    Matcher matcher;
    Matcher::TimePoint now = start;
    std::vector<std::weak_ptr<Acknowledgement>> tickets;
};

using Sets = std::vector<Sequences>;
inline const Made lossless{.lossless = true};

}  // namespace hive::event::matching
