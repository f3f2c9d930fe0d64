// Restores the order of the results of a group by its turns, which have no gaps even if the source skips. Pure logic:
// no clock of its own.
#pragma once

#include <hive/event.hpp>

#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace hive {

/// Results without a turn pass unchanged: their sender keeps the order.
class Reorder {
public:
    using TimePoint = std::chrono::steady_clock::time_point;

    static constexpr std::size_t live_window = 64;  ///< maximum number of live results that wait for an earlier one
    /// For a closed turn: the result may still be in flight, or the worker made none.
    static constexpr std::chrono::milliseconds closed_timeout{200};
    /// For a live turn that was dispatched before receiving began, and that no worker has in hand. A lossless one
    /// either comes or is closed soon.
    static constexpr std::chrono::milliseconds join_timeout{500};
    static constexpr std::size_t remembered_turns = 1000;  ///< kept of those given up
    static constexpr std::size_t max_sources = 64;         ///< maximum number of sources per line

    explicit Reorder(std::chrono::milliseconds timeout) : timeout_(timeout) {}

    /// The standing of a worker when receiving from it began: how far the group was, and the turns that the worker had
    /// in hand, whose results will arrive.
    void expect(const Share& standing, const std::vector<std::int64_t>& open);
    /// @return  false: its turn was given up, has failed, or is before the first one; the result is discarded
    bool push(Event event, TimePoint now);
    /// This turn gets no further result: it already has one.
    void skip(const Identity& identity, TimePoint now);
    /// This turn has no result: it was reported as failed.
    void fail(const Identity& identity, TimePoint now);
    /// The sources have ended: waits only shortly for results that are missing now.
    void finish(TimePoint now);
    /// Gives up turns after their deadline.
    void expire(TimePoint now);
    /// The next event in order, if it has arrived.
    std::optional<Event> pop();
    /// When expire() may have something to do.
    [[nodiscard]] std::optional<TimePoint> deadline() const;
    /// Is no event waiting?
    [[nodiscard]] bool empty() const { return ready_.empty() && !deadline(); }
    [[nodiscard]] std::int64_t failed() const noexcept { return failed_; }
    [[nodiscard]] std::int64_t missing() const noexcept { return missing_; }
    /// The first missing turns, by group: "camera.image#workers".
    [[nodiscard]] const std::map<std::string, std::vector<std::int64_t>>& missing_turns() const noexcept
    {
        return missing_turns_;
    }

private:
    using Key = std::pair<std::string, std::int64_t>;                     ///< the group, and its epoch
    using Capture = std::tuple<std::string, std::int64_t, std::int64_t>;  ///< source, epoch, sequence
    static Capture capture_of(const Event& event)
    {
        return {event.identity.source, event.identity.epoch, event.identity.sequence};
    }
    struct Line {
        std::int64_t first = 0;     ///< the first turn received; 0: not known yet
        std::int64_t expected = 0;  ///< the next turn
        std::int64_t closed = 0;    ///< this turn and all before it are closed
        std::int64_t joined = 0;    ///< the last that was dispatched before receiving began
        bool lossless = false;
        bool finished = false;        ///< the source has ended
        std::set<std::int64_t> open;  ///< of those up to joined: in hand of a worker
        std::set<std::int64_t> failed;
        std::set<std::int64_t> skipped;     ///< not waited for, but a result is accepted
        std::set<std::int64_t> passed;      ///< given up
        std::set<std::int64_t> unanswered;  ///< of those, closed ones that seemed to have no result
        std::multimap<std::int64_t, Event> waiting;
        TimePoint stuck_since{};
        std::map<std::string, std::int64_t> sources;  ///< and the run of each source in its last event
        std::optional<Capture> reached;               ///< the last one returned
        [[nodiscard]] bool has(const Identity& identity) const;
    };
    /// A restarted drone dispatches its unfinished work again, within the same run of its source. So the turns of the
    /// drone's earlier run are not gaps, and their results are sorted by capture among the new ones.
    struct Earlier {
        Event event;
        TimePoint since;
    };
    void end_earlier_runs(const Key& key, const Identity& identity, TimePoint now);
    [[nodiscard]] const Line* later_run(const Key& key, const Identity& identity) const;
    void hand_out(Line& line, Event event);
    void advance(Line& line, TimePoint now);
    void give_up(const Key& key, Line& line, TimePoint now);
    void miss(const Key& key, std::int64_t turn);
    [[nodiscard]] bool behind_waiting(const Capture& capture) const;
    [[nodiscard]] TimePoint due(const Line& line) const;
    [[nodiscard]] TimePoint due(const Earlier& earlier) const;
    [[nodiscard]] static bool answered(const Line& line, std::int64_t turn);
    static Key key_of(const Share& share) { return {share.of, share.epoch}; }

    std::chrono::milliseconds timeout_;
    std::map<Key, Line> lines_;
    std::multimap<Capture, Earlier> earlier_;
    bool finished_ = false;
    std::deque<Event> ready_;
    std::int64_t missing_ = 0, failed_ = 0;
    std::map<std::string, std::vector<std::int64_t>> missing_turns_;
};

}  // namespace hive
