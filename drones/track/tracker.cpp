// Predicts where every track should be, pairs tracks with boxes, corrects what was paired, ends and begins the others.
#include "tracker.hpp"

#include "assignment.hpp"

#include <algorithm>
#include <cmath>

namespace track {
namespace {

/// Deviations in sides of a box (the root of its area): of a measured middle, and of the speed of something new.
constexpr double place_noise = 0.1, first_speed = 2;
/// A size follows the measured ones within about this time, s.
constexpr double size_settles = 0.15;
/// So many times `forget` tracks may share one box; then it is taken for one thing that was followed twice.
constexpr int share_patience = 4;
/// What leaving a track and a box alone costs; a pair costs less.
constexpr double alone = 1;

double side(double w, double h) { return std::sqrt(w * h); }

double diagonal(const Box& box) { return std::hypot(box.w, box.h); }

bool within(const Box& box, double x, double y)
{
    return x >= box.x && x < box.x + box.w && y >= box.y && y < box.y + box.h;
}

double distance(const Box& a, const Box& b)
{
    return std::hypot(a.x + a.w / 2 - b.x - b.w / 2, a.y + a.h / 2 - b.y - b.h / 2);
}

}  // namespace

double intersection_over_union(const Box& a, const Box& b)
{
    const double w = std::min(a.x + a.w, b.x + b.w) - std::max(a.x, b.x),
                 h = std::min(a.y + a.h, b.y + b.h) - std::max(a.y, b.y);
    const double both = std::max(0.0, w) * std::max(0.0, h);
    return both / (a.w * a.h + b.w * b.h - both);
}

Tracker::Followed::Followed(std::int64_t id, const Box& box)
    : x(box.x + box.w / 2, place_noise * side(box.w, box.h), first_speed * side(box.w, box.h)),
      y(box.y + box.h / 2, place_noise * side(box.w, box.h), first_speed * side(box.w, box.h)),
      w(box.w),
      h(box.h)
{
    track.id = id;
    track.box = box;
}

Box Tracker::Followed::box() const { return {x.place() - w / 2, y.place() - h / 2, w, h}; }

void Tracker::Followed::predict(double passed, double agility)
{
    x.predict(passed, agility * side(w, h));
    y.predict(passed, agility * side(w, h));
    since_hit += passed;
    track.seconds += passed;
    ++track.age;
    ++track.missing;
}

/// The size is the mean of the first boxes, and follows slowly later.
void Tracker::Followed::take(const Box& box, double passed)
{
    ++track.hits;
    track.missing = shared = 0;
    since_hit = 0;
    x.correct(box.x + box.w / 2, place_noise * side(w, h));
    y.correct(box.y + box.h / 2, place_noise * side(w, h));
    const double share = std::max(1.0 / track.hits, 1 - std::exp(-passed / size_settles));
    w += share * (box.w - w);
    h += share * (box.h - h);
}

void Tracker::Followed::tell()
{
    track.box = box();
    track.speed_x = x.speed();
    track.speed_y = y.speed();
}

std::vector<Track> Tracker::next(double seconds, std::span<const Box> boxes)
{
    predict(seconds);
    const std::vector<bool> taken = match(boxes);
    std::erase_if(followed_, [this](const Followed& one) { return over(one); });
    bear(boxes, taken);
    std::vector<Track> tracks;
    for (Followed& one : followed_) {
        one.track.confirmed = one.track.confirmed || one.track.hits >= confirm;
        one.tell();
        tracks.push_back(one.track);
    }
    return tracks;
}

void Tracker::restart()
{
    followed_.clear();
    last_.reset();
}

void Tracker::predict(double seconds)
{
    const double passed = last_ ? seconds - *last_ : 0;
    if (passed < 0 || passed > max_gap)
        followed_.clear();
    for (Followed& one : followed_)
        one.predict(passed, agility);
    last_ = seconds;
}

/// Which boxes belong to tracks that were there before?
std::vector<bool> Tracker::match(std::span<const Box> boxes)
{
    std::vector<bool> taken = share(boxes);
    CostTable costs(followed_.size(), boxes.size());
    for (std::size_t row = 0; row < costs.rows(); ++row)
        for (std::size_t column = 0; column < boxes.size(); ++column)
            costs.at(row, column) = taken[column] ? alone : cost(followed_[row].box(), boxes[column]);
    for (const Pair& pair : assign(costs))
        if (costs.at(pair.row, pair.column) < alone) {
            Followed& one = followed_[pair.row];
            one.take(boxes[pair.column], one.since_hit);
            taken[pair.column] = true;
        }
    return taken;
}

/// Which boxes show several tracks at once? Such a box says that they are there, but not where, so they go on as
/// predicted until they part.
std::vector<bool> Tracker::share(std::span<const Box> boxes)
{
    std::vector<bool> shared;
    for (const auto& some : gathered(boxes)) {
        shared.push_back(some.size() > 1);
        for (Followed* one : some)
            if (shared.back()) {
                one->track.missing = 0;
                ++one->shared;
            }
    }
    return shared;
}

/// For each box the confirmed tracks whose middles are expected in it and in no other box.
std::vector<std::vector<Tracker::Followed*>> Tracker::gathered(std::span<const Box> boxes)
{
    std::vector<std::vector<Followed*>> inside(boxes.size());
    for (Followed& one : followed_) {
        if (!one.track.confirmed || one.shared >= share_patience * forget)
            continue;
        const auto here = [&](const Box& box) { return within(box, one.x.place(), one.y.place()); };
        const auto first = std::ranges::find_if(boxes, here);
        if (first != boxes.end() && std::none_of(first + 1, boxes.end(), here))
            inside[static_cast<std::size_t>(first - boxes.begin())].push_back(&one);
    }
    return inside;
}

/// From 0 for the expected box itself to `alone` at the gate and beyond: half for the overlap, half for the distance.
double Tracker::cost(const Box& expected, const Box& box) const
{
    const double far = distance(expected, box) / (gate * (diagonal(expected) + diagonal(box)) / 2);
    return far >= 1 ? alone : alone * (0.5 * far + 0.5 * (1 - intersection_over_union(expected, box)));
}

/// Has it been missing for too long, or gone out of the picture?
bool Tracker::over(const Followed& one) const
{
    const Box box = one.box();
    const bool left =
        width > 0 && height > 0 && (box.x >= width || box.y >= height || box.x + box.w <= 0 || box.y + box.h <= 0);
    return left || one.track.missing >= (one.track.confirmed ? forget : 1);
}

void Tracker::bear(std::span<const Box> boxes, const std::vector<bool>& taken)
{
    for (std::size_t i = 0; i < boxes.size() && followed_.size() < most_boxes; ++i)
        if (!taken[i])
            followed_.emplace_back(++ids_, boxes[i]);
}

}  // namespace track
