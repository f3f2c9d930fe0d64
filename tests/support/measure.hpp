// Statistics of repeated measurements and of collected events.
#pragma once

#include <swarm.hpp>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace hive::test {

template <class Number>
Number median(std::vector<Number> values)
{
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
}

/// The median of the wall time of a whole command, which must succeed every time.
inline double median_ms(const Swarm& swarm, const std::vector<std::string>& words, int times)
{
    std::vector<double> took;
    for (int i = 0; i < times; ++i) {
        const auto finished = swarm.hivectl(words);
        if (finished.exit_code != 0)
            throw std::runtime_error("hivectl " + words[0] + " exited with " + std::to_string(finished.exit_code) + ": "
                                     + finished.err);
        took.push_back(static_cast<double>(finished.took.count()) / 1000);
    }
    return median(std::move(took));
}

/// Events per second of a source with `batch` events per period: exact for every phase.
inline double rate(Collector& collector, int batch, int periods, Milliseconds timeout = Milliseconds(5000))
{
    const auto take = [&](int count) {
        for (int i = 0; i < count; ++i)
            if (!collector.next(patient(timeout)))
                throw std::runtime_error("no event came any more");
        return Clock::now();
    };
    const auto begin = take(1);
    const auto end = take(batch * periods);
    return batch * periods / std::chrono::duration<double>(end - begin).count();
}

/// The load of the machine over the last minute, since other work may disturb the measurement.
inline std::string machine_load()
{
    std::string one;
    std::ifstream("/proc/loadavg") >> one;
    return one;
}

/// Arrival times of results, by drone.
using Arrivals = std::map<std::string, std::vector<Clock::time_point>>;

/// Over a while.
inline Arrivals arrivals(Collector& collector, Milliseconds time)
{
    Arrivals result;
    for (const auto end = Clock::now() + time; Clock::now() < end;)
        if (const auto event = collector.next(Milliseconds(100)))
            result[event->sender].push_back(Clock::now());
    return result;
}

/// Events per second from arrival times.
inline double rate_of(const std::vector<Clock::time_point>& times)
{
    if (times.size() < 3)
        throw std::runtime_error("too few events came to tell a rate");
    return static_cast<double>(times.size() - 1) / std::chrono::duration<double>(times.back() - times.front()).count();
}

}  // namespace hive::test
