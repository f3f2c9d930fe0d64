// How well tracks keep to the things that they follow, against the truth.
#pragma once

#include "media.hpp"
#include "overlap.hpp"

#include <tracker.hpp>

#include <algorithm>
#include <map>
#include <span>
#include <vector>

namespace scoring {

using media::TrueBox;

/// Counts as in "CLEAR MOT" (Bernardin and Stiefelhagen, 2008): a thing keeps its track while that is near enough;
/// another one is a switch.
class Identities {
public:
    int truths = 0, covered = 0, switches = 0, false_tracks = 0;

    void add(std::span<const track::Track> tracks, std::span<const TrueBox> truth, double enough)
    {
        std::vector<track::Track> left;
        std::ranges::copy_if(tracks, std::back_inserter(left),
                             [](const track::Track& one) { return one.confirmed && one.missing == 0; });
        std::vector<TrueBox> open;
        for (const TrueBox& thing : truth)
            if (!keep(thing, left, enough))
                open.push_back(thing);
        for (const TrueBox& thing : open)
            find(thing, left, enough);
        truths += static_cast<int>(truth.size());
        false_tracks += static_cast<int>(left.size());
    }

private:
    static double overlap_of(const TrueBox& thing, const track::Track& one)
    {
        return overlap::intersection_over_union(thing.box, {one.box.x, one.box.y, one.box.w, one.box.h});
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

    void find(const TrueBox& thing, std::vector<track::Track>& left, double enough)
    {
        const auto best =
            std::ranges::max_element(left, {}, [&](const track::Track& one) { return overlap_of(thing, one); });
        if (best == left.end() || overlap_of(thing, *best) < enough)
            return;
        const auto [known, first] = last_.try_emplace(thing.id, best->id);
        if (!first && known->second != best->id)
            ++switches;
        known->second = best->id;
        left.erase(best);
        ++covered;
    }

    std::map<int, std::int64_t> last_;  ///< the track of each thing
};

}  // namespace scoring
