// Puts the results of workers that share a job back into the order of the job's turns, which have no gaps even when the
// source skips. Pure logic: no clock of its own.
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

/// What is not shared work comes as it came: each sender keeps the order by itself.
class Reorder {
public:
    using TimePoint = std::chrono::steady_clock::time_point;

    static constexpr std::size_t live_window = 64;  ///< live results waiting for an earlier one, at most
    /// For a turn that has had its answer: the result may still be on its way here, or the worker gave none.
    static constexpr std::chrono::milliseconds closed_patience{200};
    /// For a turn that was given out when this began to receive, and that no worker has in hand.
    static constexpr std::chrono::milliseconds join_patience{500};
    static constexpr std::size_t remembered_turns = 1000;  ///< that were given up
    static constexpr std::size_t max_sources = 64;         ///< whose runs a line knows

    explicit Reorder(std::chrono::milliseconds patience) : patience_(patience) {}

    /// What a worker told when this began to receive its results: how far the group was, and the turns that it had in
    /// hand, whose results will come.
    void expect(const Share& standing, const std::vector<std::int64_t>& open);
    /// @return  false: its turn was given up, has failed, or lies before the one that this began with; the result is
    /// left out
    bool push(Event event, TimePoint now);
    /// This turn gets no result, since its work has one already.
    void skip(const Identity& identity, TimePoint now);
    /// This turn has no result: it was reported as failed.
    void fail(const Identity& identity, TimePoint now);
    /// Nothing more will come: what is missing now is not waited for much longer.
    void finish(TimePoint now);
    /// Gives up what has been waited for too long.
    void expire(TimePoint now);
    /// The next event in order, if it is here.
    std::optional<Event> pop();
    /// When expire() may have something to do.
    [[nodiscard]] std::optional<TimePoint> deadline() const;
    /// Does nothing wait here?
    [[nodiscard]] bool empty() const { return ready_.empty() && !deadline(); }
    [[nodiscard]] std::int64_t failed() const noexcept { return failed_; }
    [[nodiscard]] std::int64_t missing() const noexcept { return missing_; }
    /// The first of the turns that are missing, by whose they are: "camera.image#workers".
    [[nodiscard]] const std::map<std::string, std::vector<std::int64_t>>& missing_turns() const noexcept
    {
        return missing_turns_;
    }

private:
    using Key = std::pair<std::string, std::int64_t>;                     ///< whose turns, in which epoch
    using Capture = std::tuple<std::string, std::int64_t, std::int64_t>;  ///< source, epoch, sequence
    static Capture capture_of(const Event& event)
    {
        return {event.identity.source, event.identity.epoch, event.identity.sequence};
    }
    struct Line {
        std::int64_t first = 0;     ///< the turn that this began with; 0: not known yet
        std::int64_t expected = 0;  ///< the next turn
        std::int64_t closed = 0;    ///< this turn and all before it have had their answer
        std::int64_t joined = 0;    ///< the last that had been given out when this began to receive
        bool lossless = false;
        bool finished = false;        ///< nothing more will come
        std::set<std::int64_t> open;  ///< of those up to joined: a worker has them in hand
        std::set<std::int64_t> failed;
        std::set<std::int64_t> skipped;     ///< no result is waited for, but one that comes is taken
        std::set<std::int64_t> passed;      ///< given up
        std::set<std::int64_t> unanswered;  ///< of those, the closed ones that have no result, as it seemed
        std::multimap<std::int64_t, Event> waiting;
        TimePoint stuck_since{};
        std::map<std::string, std::int64_t> sources;  ///< and the run of each that the last event was of
        std::optional<Capture> reached;               ///< the last that was handed out
        [[nodiscard]] bool has(const Identity& identity) const;
    };
    /// Of one run of its source, a drone that was started again gives out anew what it had not finished. So the turns
    /// of its earlier run are no gaps, and their results stand where their captures are among those of the new ones.
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

    std::chrono::milliseconds patience_;
    std::map<Key, Line> lines_;
    std::multimap<Capture, Earlier> earlier_;
    bool finished_ = false;
    std::deque<Event> ready_;
    std::int64_t missing_ = 0, failed_ = 0;
    std::map<std::string, std::vector<std::int64_t>> missing_turns_;
};

}  // namespace hive
