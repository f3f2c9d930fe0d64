// Where a round is played: on real drones, or in the simulated world.
#pragma once

#include "model.hpp"
#include "orders.hpp"
#include "printed.hpp"
#include "received.hpp"
#include "status_of.hpp"
#include "values.hpp"

#include <algorithm>
#include <chrono>
#include <functional>

namespace hive::mixtures {

/// The drones of a topology, a collector of their results that stays, and somebody who gives orders. All functions are
/// for the thread that gives them.
class Ground {
public:
    using Clock = std::chrono::steady_clock;

    virtual ~Ground() = default;
    [[nodiscard]] virtual Clock::time_point now() const = 0;
    virtual void sleep(std::chrono::microseconds time) = 0;
    /// Does both, the one beside the other.
    virtual void at_once(const std::function<void()>& one, const std::function<void()>& other) = 0;
    /// When nothing has changed for so long, nothing moves. A source must say within 1 s why it does not.
    [[nodiscard]] virtual std::chrono::milliseconds stillness() const { return std::chrono::milliseconds(1100); }
    /// Until nothing moves. Places are kept for 30 s, and so long an ordered collector waits.
    [[nodiscard]] virtual std::chrono::milliseconds longest_settling() const { return std::chrono::seconds(45); }

    /// Since its drones began.
    [[nodiscard]] virtual std::chrono::microseconds age() const = 0;
    /// Of the ages of events, at most; empty: it is not known.
    [[nodiscard]] virtual std::optional<std::chrono::microseconds> age_error() const
    {
        return std::chrono::microseconds(0);
    }
    /// A source on demand produces so soon when all have asked.
    [[nodiscard]] virtual std::chrono::milliseconds pace() const { return stillness(); }

    /// Does the machine never hold up a process for long?
    [[nodiscard]] virtual bool punctual() const { return false; }

    /// Has the network ended a connection between two machines as if the peer had died?
    [[nodiscard]] virtual bool was_cut(const std::string& /*drone*/, const std::string& /*peer*/) const
    {
        return false;
    }

    /// Addresses of a drone.
    [[nodiscard]] virtual std::int64_t max_places() const { return 1; }

    /// Do all drones hear at once what others send?
    [[nodiscard]] virtual bool all_hear() const { return true; }

    virtual void connect(const Edge& edge) = 0;
    /// The first connections, of all drones. @return whether no event was sent before all were there
    virtual bool begin(const std::vector<Edge>& edges)
    {
        std::for_each(edges.rbegin(), edges.rend(), [this](const Edge& edge) { connect(edge); });
        return false;
    }
    /// By an application of its own: two may be under way.
    virtual std::vector<ConnectAnswer> connect(const std::vector<SwarmConnection>& connections,
                                               std::chrono::milliseconds timeout) = 0;
    /// All steps but the sets and `connect all`. Throws what a drone answers.
    virtual void perform(const Step& step) = 0;
    /// How many events the source may make.
    [[nodiscard]] virtual std::int64_t fed() const = 0;
    virtual Told set(const Change& change) = 0;

    /// Those that can answer.
    [[nodiscard]] virtual std::vector<std::string> answering() const = 0;
    /// Of those that can answer.
    virtual Statuses statuses() = 0;
    /// Parameters of the workers that can answer.
    virtual Settings settings() = 0;
    /// The parameter `count` of the source.
    virtual std::int64_t count() = 0;
    /// Numbers the latest starts of the drones; all begin with 0.
    [[nodiscard]] virtual const std::map<std::string, int>& born() const = 0;

    /// What has come since the last call, in the order of its coming.
    virtual std::vector<Outcome> outcomes() = 0;
    virtual CollectCounts collected() = 0;
    /// Does the collector know that nothing more comes, and what does it say about that?
    virtual std::optional<std::string> ended() { return std::nullopt; }

    /// How many receive the results.
    [[nodiscard]] virtual std::int64_t collectors() const { return 1; }
    /// Ends the source: what a second collector has printed until then. Nothing: there is none.
    virtual std::optional<Printed> end_source() { return std::nullopt; }

    /// Promises that the ground itself has seen broken since the last call.
    virtual std::vector<std::string> complaints() { return {}; }
    /// Drones that have ended by themselves, which none may.
    virtual std::vector<std::string> fallen() = 0;
    /// Ends all by order; says what is left of them.
    virtual std::vector<std::string> end() = 0;
    /// What the bystanders have received until then.
    virtual std::vector<Received> received() { return {}; }
};

/// The first of a worker.
inline constexpr Setting first_setting{.work_ms = 4, .most_ms = 600'000};

}  // namespace hive::mixtures
