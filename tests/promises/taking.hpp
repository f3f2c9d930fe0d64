// What the tests of promises have in common: results taken and named by their sequences, and defences switched off.
#pragma once

#include "counts.hpp"
#include "switched_off.hpp"

#include <doctest/doctest.h>

#include <set>

namespace hive::test {

using namespace std::chrono_literals;

using Sequences = std::vector<std::int64_t>;

/// As text, so that a failed test shows them.
inline std::string listed(const auto& sequences)
{
    std::string text;
    for (const auto sequence : sequences)
        text += (text.empty() ? "" : " ") + std::to_string(sequence);
    return text;
}

inline Sequences one_to(std::int64_t last)
{
    Sequences all;
    for (std::int64_t i = 1; i <= last; ++i)
        all.push_back(i);
    return all;
}

inline Sequences sorted(Sequences sequences)
{
    std::ranges::sort(sequences);
    return sequences;
}

/// The sequences of the next events, as they come: so many, or fewer when none came for a while.
inline Sequences take(Collector& collector, std::size_t count, Milliseconds timeout = 5000ms)
{
    Sequences sequences;
    while (sequences.size() < count) {
        const auto event = collector.next(patient(timeout));
        if (!event)
            break;
        sequences.push_back(event->identity.sequence);
    }
    return sequences;
}

/// How many events come until none has come for a while: what must not be there is waited for no longer than that.
inline std::size_t rest(Collector& collector, Milliseconds silence = 300ms)
{
    std::size_t count = 0;
    while (collector.next(silence))
        ++count;
    return count;
}

/// What `collect` is told by those who want the results of shared work in order.
inline const CollectOptions in_order{.ordered = true};

/// Members of one group, with as long a lease as they need.
inline ConnectionOptions member_of(const std::string& group, int window = 1,
                                   std::optional<Milliseconds> lease = 60'000ms)
{
    return {.window = window, .group = group, .lease = lease};
}

/// Gives a drone something to do that is no other drone's doing, and returns when it is at it.
inline void keep_busy(Application& application, const std::string& drone, const std::string& input = "image")
{
    application.put({drone, input}, Json::object(), Body(std::string("x")), "text/plain");
    REQUIRE(eventually([&] { return is_busy(application, drone); }));
}

}  // namespace hive::test
