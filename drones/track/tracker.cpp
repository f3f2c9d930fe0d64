// Predicts every track, pairs tracks with boxes in three rounds, corrects pairs, and ends and starts the others.
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
/// Multiple of `forget` for which tracks may share one box; then they are treated as one object.
constexpr int max_shared_factor = 4;
/// A box within this distance of the border of the image may be cut off there, px.
constexpr double at_border = 2;
/// Frames without a box after which a track counts as lost.
constexpr int lost = 3;
/// The cost of leaving a track and a box unpaired; a pair must cost less.
constexpr double alone = 1;
/// The share of each new observation in the appearance, after the first ones.
constexpr double look_settles = 0.1;
/// Appearances with a larger difference belong to different objects; with a smaller one, a lost track may match.
constexpr double stranger = 0.8, same_look = 0.3;
/// A lost track may reappear within this multiple of the gate from its expected position.
constexpr double return_reach = 2;
/// A weak box must overlap the expected one so much, and something in the place of another thing too.
constexpr double weak_overlap = 0.3, same_place = 0.5;

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
      h(box.h),
      look(box.look)
{
    track.id = id;
}

Box Tracker::Followed::box() const
{
    Box box;
    box.x = x.place() - w / 2;
    box.y = y.place() - h / 2;
    box.w = w;
    box.h = h;
    return box;
}

void Tracker::Followed::predict(double passed, double agility)
{
    x.predict(passed, agility * side(w, h));
    y.predict(passed, agility * side(w, h));
    since_hit += passed;
    track.seconds += passed;
    ++track.age;
    ++track.missing;
    has_box = false;
}

/// The size is the mean of the first boxes, and follows slowly later.
void Tracker::Followed::take(const Box& box, double passed)
{
    ++track.hits;
    track.missing = shared = 0;
    since_hit = 0;
    has_box = true;
    follow(look, box.look, std::max(1.0 / track.hits, look_settles));
    x.correct(box.x + box.w / 2, place_noise * side(w, h));
    y.correct(box.y + box.h / 2, place_noise * side(w, h));
    const double share = std::max(1.0 / track.hits, 1 - std::exp(-passed / size_settles));
    w += share * (box.w - w);
    h += share * (box.h - h);
}

std::vector<Track> Tracker::next(double seconds, std::span<const Box> boxes)
{
    predict(seconds);
    const std::vector<bool> taken = match(boxes);
    notice_replaced(boxes);
    std::erase_if(followed_, [this](const Followed& one) { return over(one); });
    bear(boxes, taken);
    std::vector<Track> tracks;
    for (Followed& one : followed_) {
        one.track.confirmed = one.track.confirmed || one.track.hits >= confirm;
        one.track.box = visible(one.box());
        one.track.speed_x = one.x.speed();
        one.track.speed_y = one.y.speed();
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

/// Pairs boxes with existing tracks: first the strong boxes, then the weak ones, as in Zhang and others, "ByteTrack"
/// (2022); then lost tracks with boxes of the same appearance further away.
std::vector<bool> Tracker::match(std::span<const Box> boxes)
{
    std::vector<bool> taken = share(boxes);
    pair({.weak = false, .cost = &Tracker::cost}, boxes, taken);
    pair({.weak = true, .cost = &Tracker::cost_of_weak}, boxes, taken);
    pair({.weak = false, .cost = &Tracker::cost_of_return}, boxes, taken);
    return taken;
}

void Tracker::pair(const Round& round, std::span<const Box> boxes, std::vector<bool>& taken)
{
    CostTable costs(followed_.size(), boxes.size());
    for (std::size_t row = 0; row < costs.rows(); ++row)
        for (std::size_t column = 0; column < boxes.size(); ++column) {
            const bool open = !followed_[row].has_box && !taken[column] && (boxes[column].score < strong) == round.weak;
            costs.at(row, column) = open ? std::min(alone, (this->*round.cost)(followed_[row], boxes[column])) : alone;
        }
    for (const Pair& pair : assign(costs))
        if (costs.at(pair.row, pair.column) < alone) {
            Followed& one = followed_[pair.row];
            one.take(completed(one, boxes[pair.column]), one.since_hit);
            taken[pair.column] = true;
        }
}

/// Finds boxes that show several tracks at once. Such a box proves their presence, but not their positions, so they
/// continue as predicted until they part.
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

/// For each box the confirmed tracks whose middles are expected in it and in no other box. Lost tracks are excluded:
/// their positions are guesses, and the box may belong to one other track.
std::vector<std::vector<Tracker::Followed*>> Tracker::gathered(std::span<const Box> boxes)
{
    std::vector<std::vector<Followed*>> inside(boxes.size());
    for (Followed& one : followed_) {
        if (!one.track.confirmed || one.track.missing > lost || one.shared >= max_shared_factor * forget)
            continue;
        const auto here = [&](const Box& box) { return within(box, one.x.place(), one.y.place()); };
        const auto first = std::ranges::find_if(boxes, here);
        if (first != boxes.end() && std::none_of(first + 1, boxes.end(), here))
            inside[static_cast<std::size_t>(first - boxes.begin())].push_back(&one);
    }
    return inside;
}

/// Is something of an entirely different appearance in its place? Then the track has drifted off its object, usually
/// onto the background.
void Tracker::notice_replaced(std::span<const Box> boxes)
{
    for (Followed& one : followed_) {
        const auto replaces = [&](const Box& box) {
            return appearance > 0 && difference(one.look, box.look).value_or(0) > stranger
                   && intersection_over_union(one.box(), box) >= same_place;
        };
        one.replaced = !one.has_box && std::ranges::any_of(boxes, replaces) ? one.replaced + 1 : 0;
    }
}

/// For an object that is cut off by the border of the image, only the inner edge shows its position: its size stays. So
/// it leaves at its speed, and does not stay at the border until another object enters.
Box Tracker::completed(const Followed& one, const Box& box) const
{
    Box whole = box;
    const auto complete = [](double& begin, double& length, double known, double border) {
        const bool at_begin = begin <= at_border, at_end = begin + length >= border - at_border;
        if (border <= 0 || at_begin == at_end || length >= known)
            return;
        begin -= at_begin ? known - length : 0;
        length = known;
    };
    complete(whole.x, whole.w, one.w, width);
    complete(whole.y, whole.h, one.h, height);
    return whole;
}

/// The part in the image, if its size is known and there is one.
Box Tracker::visible(const Box& box) const
{
    const double right = std::min(box.x + box.w, width), bottom = std::min(box.y + box.h, height);
    Box part = box;
    part.x = std::max(box.x, 0.0);
    part.y = std::max(box.y, 0.0);
    part.w = right - part.x;
    part.h = bottom - part.y;
    return width > 0 && height > 0 && part.w > 0 && part.h > 0 ? part : box;
}

/// From 0 for the expected box itself, with the same looks, to `alone` at the gate and beyond. Of the motion's part the
/// overlap and the distance are half each.
double Tracker::cost(const Followed& one, const Box& found) const
{
    const Box expected = one.box(), box = completed(one, found);
    const double far = distance(expected, box) / (gate * (diagonal(expected) + diagonal(box)) / 2);
    if (far >= 1)
        return alone;
    const double motion = 0.5 * far + 0.5 * (1 - intersection_over_union(expected, box));
    const auto looks = appearance > 0 ? difference(one.look, box.look) : std::nullopt;
    if (!looks)
        return alone * motion;
    return *looks > stranger ? alone : alone * ((1 - appearance) * motion + appearance * *looks);
}

/// A weak box is accepted only where a track is expected, with any appearance.
double Tracker::cost_of_weak(const Followed& one, const Box& box) const
{
    const double overlap = intersection_over_union(one.box(), box);
    return one.track.confirmed && overlap >= weak_overlap ? alone * (1 - overlap) : alone;
}

/// For tracks that missed a frame before, and may be elsewhere by now.
double Tracker::cost_of_return(const Followed& one, const Box& box) const
{
    const double looks = appearance > 0 ? difference(one.look, box.look).value_or(1) : 1;
    if (!one.track.confirmed || one.track.missing < 2 || looks > same_look)
        return alone;
    const Box expected = one.box();
    const double far = distance(expected, box) / (return_reach * gate * (diagonal(expected) + diagonal(box)) / 2);
    return far >= 1 ? alone : alone * (far + looks) / 2;
}

/// Has it been missing for too long, gone out of the image, or been replaced by something else?
bool Tracker::over(const Followed& one) const
{
    const double x = one.x.place(), y = one.y.place();
    const bool left = width > 0 && height > 0 && (x < 0 || y < 0 || x > width || y > height);
    return left || one.replaced >= confirm || one.track.missing >= (one.track.confirmed ? forget : 1);
}

void Tracker::bear(std::span<const Box> boxes, const std::vector<bool>& taken)
{
    for (std::size_t i = 0; i < boxes.size() && followed_.size() < max_boxes; ++i)
        if (!taken[i] && boxes[i].score >= strong)
            followed_.emplace_back(++ids_, boxes[i]);
}

}  // namespace track
