// The tracker: births, deaths, crossings, gaps, and the same tracks for the same boxes.
#include <doctest/doctest.h>
#include <tracker.hpp>

#include <algorithm>
#include <cmath>

using track::Box;
using track::Track;
using track::Tracker;

namespace {

constexpr double rate = 0.04;  // s between frames

/// A box that moves evenly.
struct Walk {
    double x, y, speed_x, speed_y, w = 40, h = 100;
    [[nodiscard]] Box at(double time) const { return {x + speed_x * time, y + speed_y * time, w, h}; }
};

std::vector<Track> follow(Tracker& tracker, const std::vector<Walk>& walks, int from, int to)
{
    std::vector<Track> tracks;
    for (int frame = from; frame < to; ++frame) {
        std::vector<Box> boxes;
        for (const Walk& walk : walks)
            boxes.push_back(walk.at(frame * rate));
        tracks = tracker.next(frame * rate, boxes);
    }
    return tracks;
}

}  // namespace

TEST_CASE("tracker: overlap of boxes")
{
    CHECK(track::intersection_over_union({0, 0, 10, 10}, {0, 0, 10, 10}) == doctest::Approx(1));
    CHECK(track::intersection_over_union({0, 0, 10, 10}, {5, 0, 10, 10}) == doctest::Approx(1.0 / 3));
    CHECK(track::intersection_over_union({0, 0, 10, 10}, {10, 10, 5, 5}) == 0);
    CHECK(track::intersection_over_union({0, 0, 10, 10}, {30, 40, 5, 5}) == 0);
}

TEST_CASE("tracker: a track is confirmed by its third box, and one that misses earlier is forgotten")
{
    Tracker tracker;
    const std::vector<Box> box{{10, 20, 30, 60}};
    auto tracks = tracker.next(0, box);
    REQUIRE(tracks.size() == 1);
    CHECK(tracks[0].id == 1);
    CHECK(tracks[0].box == box[0]);
    CHECK_FALSE(tracks[0].confirmed);
    CHECK(tracker.next(rate, {}).empty());
    CHECK(tracker.next(2 * rate, box)[0].id == 2);
    CHECK_FALSE(tracker.next(3 * rate, box)[0].confirmed);
    tracks = tracker.next(4 * rate, box);
    CHECK(tracks[0].confirmed);
    CHECK(tracks[0].id == 2);
    CHECK(tracks[0].hits == 3);
    CHECK(tracks[0].age == 3);
    CHECK(tracks[0].seconds == doctest::Approx(2 * rate));
}

TEST_CASE("tracker: a confirmed track without boxes keeps moving, and ends after its maximum of misses")
{
    Tracker tracker;
    tracker.forget = 5;
    const Walk walk{0, 50, 200, 0};
    follow(tracker, {walk}, 0, 15);
    for (int missed = 1; missed < 5; ++missed) {
        const auto tracks = tracker.next((14 + missed) * rate, {});
        REQUIRE(tracks.size() == 1);
        CHECK(tracks[0].missing == missed);
        CHECK(tracks[0].hits == 15);
        CHECK(tracks[0].confirmed);
        CHECK(tracks[0].box.x == doctest::Approx(walk.at((14 + missed) * rate).x).epsilon(0.05));
    }
    CHECK(tracker.next(19 * rate, {}).empty());
}

TEST_CASE("tracker: a track that has left the image ends, if the image size is known")
{
    for (const bool known : {false, true}) {
        Tracker tracker;
        tracker.width = known ? 320 : 0;
        tracker.height = known ? 240 : 0;
        follow(tracker, {{0, 50, 400, 0}}, 0, 17);  // to x = 256
        CAPTURE(known);
        CHECK(tracker.next(16.5 * rate, {}).size() == 1);
        CHECK(follow(tracker, {}, 18, 22).size() == (known ? 0 : 1));
    }
}

TEST_CASE("tracker: an object leaving the image is not confused with one entering there")
{
    Tracker tracker;
    tracker.width = 320;
    tracker.height = 240;
    const auto cut = [](const Box& box) {
        const double right = std::min(box.x + box.w, 320.0);
        return Box{box.x, box.y, right - box.x, box.h};
    };
    const Walk out{200, 50, 100, 0}, in{440, 50, -100, 0};  // when one has gone the other comes
    std::vector<Track> tracks;
    for (int frame = 0; frame < 60; ++frame) {
        const double time = frame * rate;
        std::vector<Box> boxes;
        for (const Walk& walk : {out, in})
            if (walk.at(time).x < 316)
                boxes.push_back(cut(walk.at(time)));
        tracks = tracker.next(time, boxes);
        for (const Track& one : tracks)
            if (one.confirmed)
                CHECK(one.box.x + one.box.w <= 320);
    }
    REQUIRE(tracks.size() == 1);
    CHECK(tracks[0].id > 1);
    CHECK(tracks[0].box.x == doctest::Approx(in.at(59 * rate).x).epsilon(0.02));
}

TEST_CASE("tracker: an object that reappears in time where expected keeps its id; the speed is in px/s")
{
    Tracker tracker;
    const Walk walk{0, 50, 150, -30};
    follow(tracker, {walk}, 0, 20);
    follow(tracker, {}, 20, 40);
    const auto tracks = follow(tracker, {walk}, 40, 50);
    REQUIRE(tracks.size() == 1);
    CHECK(tracks[0].id == 1);
    CHECK(tracks[0].missing == 0);
    CHECK(tracks[0].speed_x == doctest::Approx(150).epsilon(0.05));
    CHECK(tracks[0].speed_y == doctest::Approx(-30).epsilon(0.05));
}

TEST_CASE("tracker: two that cross keep their ids, whether both are seen all the time or one is hidden meanwhile")
{
    const Walk right{0, 50, 160, 0}, left{400, 70, -160, 0};
    for (const bool hidden : {false, true}) {
        CAPTURE(hidden);
        Tracker tracker;
        auto tracks = follow(tracker, {right, left}, 0, 26);  // they meet at 1.25 s
        tracks = follow(tracker, hidden ? std::vector{right} : std::vector{left, right}, 26, 36);
        tracks = follow(tracker, {left, right}, 36, 60);
        REQUIRE(tracks.size() == 2);
        CHECK(tracks[0].id == 1);
        CHECK(tracks[1].id == 2);
        CHECK(tracks[0].box.x > tracks[1].box.x + 200);
        CHECK(tracks[0].speed_x > 100);
        CHECK(tracks[1].speed_x < -100);
    }
}

TEST_CASE("tracker: two that melt into one box for a while keep their ids, their speeds and their sizes")
{
    const Walk right{0, 50, 120, 0},
        left{300, 60, -120, 0};  // their boxes touch from 1.08 s to 1.42 s; then they are one for 1.2 s
    Tracker tracker;
    tracker.forget = 10;
    auto tracks = follow(tracker, {right, left}, 0, 26);
    for (int frame = 26; frame < 45; ++frame) {
        const Box a = right.at(frame * rate), b = left.at(frame * rate);
        const double x = std::min(a.x, b.x), end = std::max(a.x, b.x) + 40;
        tracks = tracker.next(frame * rate, std::vector<Box>{{x, 50, end - x, 110}});
        REQUIRE(tracks.size() == 2);
        CHECK(tracks[0].missing == 0);
        CHECK(tracks[0].hits == 26);
    }
    tracks = follow(tracker, {left, right}, 45, 50);
    REQUIRE(tracks.size() == 2);
    CHECK(tracks[0].id == 1);
    CHECK(tracks[0].box.x > tracks[1].box.x);
    CHECK(tracks[0].speed_x == doctest::Approx(120).epsilon(0.05));
    CHECK(tracks[0].box.w == doctest::Approx(40).epsilon(0.02));
}

TEST_CASE("tracker: of two tracks that stay in one box only one is left in the end")
{
    Tracker tracker;
    tracker.forget = 5;
    for (int frame = 0; frame < 10; ++frame)
        CHECK(tracker.next(frame * rate, std::vector<Box>{{100, 50, 40, 40}, {100, 95, 40, 50}}).size() == 2);
    const std::vector<Box> whole{{100, 50, 40, 95}};
    for (int frame = 10; frame < 30; ++frame)
        CHECK(tracker.next(frame * rate, whole).size() == 2);
    std::vector<Track> tracks;
    for (int frame = 30; frame < 40; ++frame)
        tracks = tracker.next(frame * rate, whole);
    REQUIRE(tracks.size() == 1);
    CHECK(tracks[0].id <= 2);
    CHECK(tracks[0].box.h == doctest::Approx(95).epsilon(0.05));
}

TEST_CASE("tracker: skipped frames are bridged by the time that really passed")
{
    const Walk walk{0, 50, 300, 0};
    for (const bool honest : {true, false}) {
        Tracker tracker;
        follow(tracker, {walk}, 0, 20);
        const double time = 19 * rate + 0.8;  // 240 px further
        const auto tracks = tracker.next(honest ? time : 20 * rate, std::vector{walk.at(time)});
        CAPTURE(honest);
        CHECK((tracks[0].id == 1 && tracks[0].missing == 0) == honest);  // a clock that counts frames would lose it
    }
}

TEST_CASE("tracker: after a gap that is too long, and when time goes back, all tracks restart with new ids")
{
    const Walk walk{100, 50, 0, 0};
    for (const double later : {2.1, -0.1}) {
        Tracker tracker;
        follow(tracker, {walk}, 0, 10);
        const auto tracks = tracker.next(9 * rate + later, std::vector{walk.at(0)});
        REQUIRE(tracks.size() == 1);
        CHECK(tracks[0].id == 2);
        CHECK(tracks[0].hits == 1);
    }
    Tracker tracker;
    follow(tracker, {walk}, 0, 10);
    CHECK(tracker.next(9 * rate + 1.9, std::vector{walk.at(0)})[0].id == 1);
}

TEST_CASE("tracker: two frames of the same time are accepted")
{
    Tracker tracker;
    const std::vector<Box> box{{10, 20, 30, 60}};
    for (int i = 0; i < 5; ++i) {
        const auto tracks = tracker.next(1, box);
        REQUIRE(tracks.size() == 1);
        CHECK(tracks[0].id == 1);
        CHECK(tracks[0].speed_x == 0);
        CHECK(std::isfinite(tracks[0].box.x));
    }
}

TEST_CASE("tracker: a box beyond the gate is another object")
{
    for (const double gate : {0.2, 0.7, 1.0}) {
        Tracker tracker;
        tracker.gate = gate;
        const Walk still{200, 200, 0, 0, 60, 80};  // its diagonal is 100 px
        follow(tracker, {still}, 0, 10);
        const auto tracks = tracker.next(10 * rate, std::vector<Box>{{240, 200, 60, 80}});
        CHECK(tracks.size() == (gate < 0.4 ? 2 : 1));
    }
}

TEST_CASE("tracker: there are never more tracks than may be, and the same boxes give the same tracks")
{
    const auto run = [] {
        Tracker tracker;
        std::vector<std::vector<Track>> all;
        for (int frame = 0; frame < 6; ++frame) {
            std::vector<Box> boxes;
            for (std::size_t i = 0; i < track::max_boxes; ++i)
                boxes.push_back(
                    {static_cast<double>(i % 16) * 50 + (frame % 2) * 30, static_cast<double>(i / 16) * 50, 20, 20});
            all.push_back(tracker.next(frame * rate, boxes));
            CHECK(all.back().size() <= track::max_boxes);
        }
        return all;
    };
    CHECK(run() == run());
}

namespace {

const track::Look red{1, 0, 0}, blue{0, 1, 0}, reddish{0.9F, 0.1F, 0}, wall{0, 0, 1};

Box looking(Box box, const track::Look& look)
{
    box.look = look;
    return box;
}

Box scored(Box box, double score)
{
    box.score = score;
    return box;
}

const Track& of_id(const std::vector<Track>& tracks, std::int64_t id)
{
    const auto found = std::ranges::find(tracks, id, &Track::id);
    REQUIRE(found != tracks.end());
    return *found;
}

}  // namespace

TEST_CASE("tracker: two objects that meet and turn back keep their ids by appearance, and lose them without")
{
    const Walk right{0, 50, 160, 0}, left{400, 50, -160, 0};  // they meet at 1.25 s
    for (const double appearance : {0.4, 0.0}) {
        CAPTURE(appearance);
        Tracker tracker;
        tracker.appearance = appearance;
        std::vector<Track> tracks;
        for (int frame = 0; frame < 60; ++frame) {
            const double time = frame * rate, turned = frame <= 31 ? time : 2.5 - time;
            const Box a = right.at(turned), b = left.at(turned);
            if (frame >= 28 && frame <= 34)  // one box for both
                tracks = tracker.next(time, std::vector<Box>{{a.x, 50, b.x + 40 - a.x, 100}});
            else
                tracks = tracker.next(time, std::vector{looking(a, red), looking(b, blue)});
        }
        CHECK((of_id(tracks, 1).box.x < 100) == (appearance > 0));
        CHECK((of_id(tracks, 2).box.x > 300) == (appearance > 0));
    }
}

TEST_CASE("tracker: a weak box extends a track and starts none; a box without a score is strong")
{
    const Walk walk{0, 50, 100, 0};
    for (const double score : {0.4, 0.6}) {
        CAPTURE(score);
        Tracker tracker;
        for (int frame = 0; frame < 5; ++frame)
            CHECK(tracker.next(frame * rate, std::vector{scored(walk.at(frame * rate), score)}).empty()
                  == (score < tracker.strong));
    }
    Tracker tracker;
    follow(tracker, {walk}, 0, 10);
    std::vector<Track> tracks;
    for (int frame = 10; frame < 60; ++frame)
        tracks = tracker.next(frame * rate, std::vector{scored(walk.at(frame * rate), 0.1)});
    REQUIRE(tracks.size() == 1);
    CHECK(tracks[0].hits == 60);
    CHECK(tracks[0].id == 1);
}

TEST_CASE("tracker: a strong box is taken before a weak one that is nearer")
{
    Tracker tracker;
    const Walk still{100, 50, 0, 0};
    follow(tracker, {still}, 0, 10);
    const auto tracks = tracker.next(10 * rate, std::vector{scored(still.at(0), 0.1), scored({112, 50, 40, 100}, 0.9)});
    REQUIRE(tracks.size() == 1);
    CHECK(tracks[0].box.x > 101);
}

TEST_CASE("tracker: a track ends when its box looks like the wall, which gets its own track")
{
    Tracker tracker;
    const Box place{100, 50, 40, 100};
    for (int frame = 0; frame < 10; ++frame)
        CHECK(tracker.next(frame * rate, std::vector{looking(place, frame % 2 ? red : reddish)}).at(0).id == 1);
    std::vector<Track> tracks;
    for (int frame = 10; frame < 13; ++frame)
        tracks = tracker.next(frame * rate, std::vector{looking(place, wall)});
    REQUIRE(tracks.size() == 1);
    CHECK(tracks[0].id == 2);
    Tracker blind;  // motion alone does not notice
    blind.appearance = 0;
    for (int frame = 0; frame < 13; ++frame)
        tracks = blind.next(frame * rate, std::vector{looking(place, frame < 10 ? red : wall)});
    CHECK(tracks.at(0).id == 1);
}

TEST_CASE("tracker: a lost object is found further away by its appearance only")
{
    const Walk walk{0, 50, 100, 0};
    for (const auto& [look, id] : {std::pair(red, 1), std::pair(blue, 2)}) {
        Tracker tracker;
        for (int frame = 0; frame < 10; ++frame)
            static_cast<void>(tracker.next(frame * rate, std::vector{looking(walk.at(frame * rate), red)}));
        for (int frame = 10; frame < 20; ++frame)
            static_cast<void>(tracker.next(frame * rate, {}));
        Box back = walk.at(20 * rate);
        back.x += 110;  // the gate ends at 75 px
        const auto tracks = tracker.next(20 * rate, std::vector{looking(back, look)});
        CHECK(tracks.back().id == id);
        CHECK(tracks.back().missing == 0);
    }
}

TEST_CASE("tracker: a box that fits one track is not shared with one that was lost there")
{
    Tracker tracker;
    const Walk walk{0, 50, 100, 0}, gone{100, 50, 0, 0};
    follow(tracker, {walk, gone}, 0, 5);
    const auto tracks = follow(tracker, {walk}, 5, 24);  // at x = 92, before the middle of the other one
    CHECK(of_id(tracks, 1).hits == 24);
    CHECK(of_id(tracks, 2).missing == 19);
}
