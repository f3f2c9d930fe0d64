// Tracks objects through a sequence of boxes, and gives each a permanent number.
#pragma once

#include "look.hpp"
#include "motion.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace track {

/// px; x and y are the left upper corner.
struct Box {
    double x = 0, y = 0, w = 0, h = 0;
    double score = std::numeric_limits<double>::infinity();  ///< confidence of its finder; default: certain
    Look look = {};                                          ///< appearance of its content
    bool operator==(const Box&) const = default;
};

double intersection_over_union(const Box& a, const Box& b);

/// A tracked object, as callers see it.
struct Track {
    std::int64_t id = 0;              ///< from 1, never used again
    Box box;                          ///< its box; predicted if it has no box of its own
    int age = 1;                      ///< frames since its first box, that one included
    double seconds = 0;               ///< since its first box
    double speed_x = 0, speed_y = 0;  ///< px/s
    int hits = 1;                     ///< boxes of its own
    int missing = 0;                  ///< frames since it was last seen, alone or in one box with others
    bool confirmed = false;           ///< had enough boxes
    bool operator==(const Track&) const = default;
};

/// Maximum boxes per frame, and maximum tracks at a time: more boxes are an error, further tracks start later.
inline constexpr std::size_t max_boxes = 256;

/// The same boxes at the same times give the same tracks.
class Tracker {
public:
    int confirm = 3;  ///< boxes, one per frame, until a track is confirmed; before, its first miss ends it. At least 1
    int forget = 30;  ///< consecutive frames without a box that end a confirmed track. At least 1
    double gate =
        0.7;  ///< how far a box may be from where it is expected, in diagonals of the two boxes (their mean). Above 0
    double agility = 2;  ///< how much the speed may change, in sides of the box (root of its area) per s^2. Above 0
    double strong =
        0.5;  ///< a box with a lower score starts no track, and only continues a track that no strong box matches
    double appearance = 0.4;       ///< weight of the appearance relative to motion, 0 to 1; 0: motion alone
    double width = 0, height = 0;  ///< of the image, px: a track that is more than half outside ends; 0: unknown
    double max_gap = 2;            ///< s; all tracks end at a larger gap between frames. Above 0

    /// The next frame. @param seconds  its time on any clock; earlier than the last one: all tracks end
    /// @param boxes  with sides above 0, at most max_boxes
    /// @return  all tracks, by id
    std::vector<Track> next(double seconds, std::span<const Box> boxes);
    /// Ends all tracks; their ids are not used again.
    void restart();

private:
    /// A track with its motion and appearance.
    struct Followed {
        Followed(std::int64_t id, const Box& box);
        void predict(double passed, double agility);
        void take(const Box& box, double passed_since_hit);
        [[nodiscard]] Box box() const;

        Track track;
        Motion x, y;  ///< of the middle
        double w, h;
        Look look;
        double since_hit = 0;  ///< s
        int shared = 0;        ///< frames in one box with others since its last own one
        int replaced = 0;      ///< consecutive frames with another appearance in its place
        bool has_box = false;  ///< of its own, in this frame
    };
    /// A round of pairing tracks without a box and boxes without a track.
    struct Round {
        bool weak;                                                   ///< with the weak boxes; otherwise the strong ones
        double (Tracker::*cost)(const Followed&, const Box&) const;  ///< below `alone`: may be a pair
    };

    void predict(double seconds);
    [[nodiscard]] std::vector<bool> match(std::span<const Box> boxes);
    void pair(const Round& round, std::span<const Box> boxes, std::vector<bool>& taken);
    [[nodiscard]] std::vector<bool> share(std::span<const Box> boxes);
    [[nodiscard]] std::vector<std::vector<Followed*>> gathered(std::span<const Box> boxes);
    void notice_replaced(std::span<const Box> boxes);
    [[nodiscard]] Box completed(const Followed& one, const Box& box) const;
    [[nodiscard]] Box visible(const Box& box) const;
    [[nodiscard]] double cost(const Followed& one, const Box& box) const;
    [[nodiscard]] double cost_of_weak(const Followed& one, const Box& box) const;
    [[nodiscard]] double cost_of_return(const Followed& one, const Box& box) const;
    [[nodiscard]] bool over(const Followed& one) const;
    void bear(std::span<const Box> boxes, const std::vector<bool>& taken);

    std::vector<Followed> followed_;  ///< by id
    std::optional<double> last_;      ///< time of the last frame
    std::int64_t ids_ = 0;
};

}  // namespace track
