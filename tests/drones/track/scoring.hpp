// How well tracks keep to the things that they follow, in the figures of the field: MOTA, IDF1, identity switches.
#pragma once

#include "overlap.hpp"
#include "truth.hpp"

#include <assignment.hpp>
#include <tracker.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <vector>

namespace scoring {

using media::TrueBox;

/// Counts as in "CLEAR MOT" (Bernardin and Stiefelhagen, 2008): a thing keeps its track while that is near enough, the
/// others are paired at the most overlap in all; another track than before is a switch. IDF1 is that of Ristani and
/// others, "Performance Measures and a Data Set for Multi-Target, Multi-Camera Tracking" (2016).
class Identities {
public:
    int truths = 0, covered = 0, switches = 0, false_tracks = 0;

    /// The next frame. Only tracks that are confirmed and were seen in it count.
    /// @param enough  minimum intersection over union of a track with its object
    void add(std::span<const track::Track> tracks, std::span<const TrueBox> truth, double enough)
    {
        std::vector<track::Track> left;
        std::ranges::copy_if(tracks, std::back_inserter(left),
                             [](const track::Track& one) { return one.confirmed && one.missing == 0; });
        count_together(left, truth, enough);
        std::vector<TrueBox> open;
        for (const TrueBox& thing : truth)
            if (!keep(thing, left, enough))
                open.push_back(thing);
        pair(open, left, enough);
        truths += static_cast<int>(truth.size());
        false_tracks += static_cast<int>(left.size());
    }

    /// 1 - (misses + boxes of tracks that follow nothing + switches) / true boxes
    [[nodiscard]] double mota() const
    {
        return truths > 0 ? 1 - static_cast<double>(truths - covered + false_tracks + switches) / truths : 1;
    }

    /// 2 * IDTP / (true boxes + boxes of tracks). IDTP: the boxes of tracks that are on the one thing that each track
    /// belongs to, when things and tracks belong to one another in the best way, one to one, from beginning to end.
    [[nodiscard]] double idf1() const
    {
        const int boxes = truths + covered + false_tracks;
        return boxes > 0 ? 2.0 * on_their_own() / boxes : 1;
    }

private:
    static double overlap_of(const TrueBox& thing, const track::Track& one)
    {
        return overlap::intersection_over_union(thing.box, {one.box.x, one.box.y, one.box.w, one.box.h});
    }

    void count_together(std::span<const track::Track> tracks, std::span<const TrueBox> truth, double enough)
    {
        for (const TrueBox& thing : truth)
            for (const track::Track& one : tracks)
                if (overlap_of(thing, one) >= enough)
                    ++together_[thing.id][one.id];
    }

    bool keep(const TrueBox& thing, std::vector<track::Track>& left, double enough)
    {
        const auto known = last_.find(thing.id);
        if (known == last_.end())
            return false;
        const auto kept = std::ranges::find_if(
            left, [&](const track::Track& one) { return one.id == known->second && overlap_of(thing, one) >= enough; });
        if (kept == left.end())
            return false;
        left.erase(kept);
        ++covered;
        return true;
    }

    void pair(const std::vector<TrueBox>& open, std::vector<track::Track>& left, double enough)
    {
        track::CostTable costs(open.size(), left.size());
        for (std::size_t row = 0; row < costs.rows(); ++row)
            for (std::size_t column = 0; column < left.size(); ++column) {
                const double overlap = overlap_of(open[row], left[column]);
                costs.at(row, column) = overlap >= enough ? 1 - overlap : 2;
            }
        std::vector<bool> used(left.size());
        for (const track::Pair& pair : track::assign(costs))
            if (costs.at(pair.row, pair.column) <= 1) {
                found(open[pair.row].id, left[pair.column].id);
                used[pair.column] = true;
            }
        for (std::size_t i = left.size(); i-- > 0;)
            if (used[i])
                left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
    }

    void found(int thing, std::int64_t id)
    {
        const auto [known, first] = last_.try_emplace(thing, id);
        if (!first && known->second != id)
            ++switches;
        known->second = id;
        ++covered;
    }

    [[nodiscard]] int on_their_own() const
    {
        std::map<std::int64_t, std::size_t> columns;
        int most = 0;
        for (const auto& [thing, tracks] : together_)
            for (const auto& [id, frames] : tracks) {
                columns.try_emplace(id, columns.size());
                most = std::max(most, frames);
            }
        track::CostTable costs(together_.size(), columns.size());
        std::size_t row = 0;
        for (const auto& [thing, tracks] : together_) {
            for (std::size_t column = 0; column < columns.size(); ++column)
                costs.at(row, column) = most;
            for (const auto& [id, frames] : tracks)
                costs.at(row, columns.at(id)) = most - frames;
            ++row;
        }
        double sum = 0;
        for (const track::Pair& pair : track::assign(costs))
            sum += most - costs.at(pair.row, pair.column);
        return static_cast<int>(sum);
    }

    std::map<int, std::int64_t> last_;                     ///< the track of each thing
    std::map<int, std::map<std::int64_t, int>> together_;  ///< of each thing and track: frames in which they overlap
};

}  // namespace scoring
