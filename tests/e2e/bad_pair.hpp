// Two machines with a bad link between them, and the rate and age of a stream over it.
#pragma once

#include "bad_link.hpp"
#include "plain_flow.hpp"
#include "status_sums.hpp"

#include <algorithm>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace hive::test {

/// All namespaces of a machine have one clock, so the true age of an event is known.
inline std::int64_t wall_us()
{
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

enum class Key { shared, none };

/// A ticker on one machine, and sleepers that receive it on another over a bad link.
class Pair {
public:
    explicit Pair(Key key = Key::shared) : lab_({"cam1", "gpu1", "cam2", "gpu2"}), key_(key)
    {
        if (key_ == Key::shared)
            lab_.share_key();
        // Loss-based congestion control, as on most machines.
        const std::string control = "> /proc/sys/net/ipv4/tcp_congestion_control";
        for (const std::size_t each : {0, 1, 2, 3})
            lab_.machine(each).net.run("echo cubic " + control + " || echo reno " + control);
    }
    void start(const std::string& settings, int sleepers = 1)
    {
        const auto address = "tcp://" + source().address;
        source().hivectl_done("start ticker --listen " + address + insecure() + settings);
        for (int i = 0; i < sleepers; ++i) {
            sleepers_.push_back("sleeper-" + std::to_string(i));
            sink().hivectl_done("start sleeper --as " + sleepers_.back());
        }
        sink().hivectl_done("place add ticker " + at_source_.status("ticker").places.at(1));
        link_ = std::make_unique<BadLink>(source(), sink());
    }
    void connect(const std::string& options)
    {
        for (const auto& sleeper : sleepers_)
            sink().hivectl_done("connect ticker " + sleeper + " --timeout 30 "
                                + options);  // the link may lose it twice
    }

    [[nodiscard]] BadLink& link() { return *link_; }
    [[nodiscard]] std::unique_ptr<PlainFlow> plain_flow(int port) const { return flow(source(), sink(), port); }
    /// Between two other machines, for a link that is as bad as this one.
    [[nodiscard]] std::unique_ptr<PlainFlow> plain_flow_beside() const
    {
        return flow(lab_.machine(2), lab_.machine(3), 9000);
    }
    [[nodiscard]] std::unique_ptr<BadLink> link_beside(const LineQuality& quality) const
    {
        return std::make_unique<BadLink>(lab_.machine(2), lab_.machine(3), quality);
    }
    [[nodiscard]] std::unique_ptr<hive::Collector> results()
    {
        std::vector<hive::Endpoint> outputs;
        for (const auto& sleeper : sleepers_)
            outputs.push_back({sleeper, "result"});
        return at_sink_.collect(outputs);
    }
    /// A counter of all sleepers.
    [[nodiscard]] std::int64_t sum(std::int64_t hive::InputStatus::*counter)
    {
        std::int64_t sum = 0;
        for (const auto& sleeper : sleepers_)
            sum += at_inputs(at_sink_.status(sleeper), counter);
        return sum;
    }
    [[nodiscard]] std::int64_t received() { return sum(&hive::InputStatus::received); }
    /// Per sleeper: the number changes when it reconnects.
    [[nodiscard]] std::vector<std::int64_t> registrations()
    {
        std::vector<std::int64_t> numbers;
        for (const auto& sleeper : sleepers_)
            numbers.push_back(at_inputs(at_sink_.status(sleeper), &hive::InputStatus::registration));
        return numbers;
    }

    /// Log lines of both ends about ended connections.
    [[nodiscard]] std::string said() const
    {
        std::string lines;
        const auto add = [&](const Machine& machine, const std::string& drone) {
            std::istringstream log(machine.swarm.log(drone));
            for (std::string line; std::getline(log, line);)
                if (line.find("lost") != std::string::npos || line.find("life") != std::string::npos)
                    lines += drone + ": " + line + "\n";
        };
        add(source(), "ticker");
        for (const auto& sleeper : sleepers_)
            add(sink(), sleeper);
        return lines;
    }

private:
    static std::unique_ptr<PlainFlow> flow(const Machine& from, const Machine& to, int port)
    {
        return std::make_unique<PlainFlow>(from.net.name(), to.net.name(), NetworkAddress{to.address, port});
    }
    [[nodiscard]] const Machine& source() const { return lab_.machine(0); }
    [[nodiscard]] const Machine& sink() const { return lab_.machine(1); }
    [[nodiscard]] std::string insecure() const { return key_ == Key::none ? " --insecure " : " "; }

    Lab lab_;
    Key key_;
    hive::Application at_source_{source().swarm.application()}, at_sink_{sink().swarm.application()};
    std::vector<std::string> sleepers_;
    std::unique_ptr<BadLink> link_;
};

/// Result of streaming for a while.
struct Watched {
    double bytes_per_second = 0;
    std::vector<std::int64_t> ages_us;
    Seconds late{};  ///< maximum delay of this thread: a stall of this machine

    /// A percentile of the ages, seconds.
    [[nodiscard]] double age(double share) const
    {
        if (ages_us.empty())
            throw std::runtime_error("no event came");
        auto sorted = ages_us;
        std::ranges::sort(sorted);
        return static_cast<double>(sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))])
               / 1e6;
    }
};

inline Watched watch(Pair& pair, Seconds time, int frame)
{
    const auto results = pair.results();
    Watched watched;
    const auto before = pair.received();
    const auto begin = Clock::now();
    constexpr Milliseconds moment(100);
    for (auto last = begin; last - begin < time;) {
        if (const auto event = results->next(moment))
            watched.ages_us.push_back(wall_us() - event->identity.captured_us);
        const auto now = Clock::now();
        watched.late = std::max<Seconds>(watched.late, now - last - moment);
        last = now;
    }
    const auto events = pair.received() - before;
    watched.bytes_per_second = static_cast<double>(events * frame) / Seconds(Clock::now() - begin).count();
    return watched;
}

}  // namespace hive::test
