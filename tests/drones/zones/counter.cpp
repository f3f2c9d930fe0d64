// Counts of tracks on made-up paths.
#include <counter.hpp>

#include <doctest/doctest.h>

using namespace zones;
using Kind = Occurrence::Kind;

namespace {

/// Frames of 10 per second, captured one hour after the epoch of the clock.
class Film {
public:
    Counter counter;

    Film(const std::string& zones, const std::string& lines) { counter.arrange(read_zones(zones), read_lines(lines)); }
    std::vector<Occurrence> frame(const std::vector<Observation>& observations)
    {
        ++count_;
        return counter.next(moment(count_), 4.0 / 3, observations);
    }
    std::vector<Occurrence> path(std::int64_t id, const std::vector<Point>& points)
    {
        std::vector<Occurrence> all;
        for (const Point point : points)
            for (const auto& one : frame({{.id = id, .anchor = point}}))
                all.push_back(one);
        return all;
    }
    static Moment moment(int frame) { return {0.1 * frame, 3'600'000'000 + 100'000LL * frame}; }
    [[nodiscard]] int last() const { return count_; }

private:
    int count_ = 0;
};

const std::string left_half = "left: 0,0 0.5,0 0.5,1 0,1", middle = "middle: 0.5,1 0.5,0",
                  level = "level: 0.2,0.5 0.8,0.5";

}  // namespace

TEST_CASE("counter: a track enters and leaves a zone, with the times of the frames and its dwell")
{
    Film film(left_half, "");
    const auto found = film.path(7, {{0.8, 0.5}, {0.4, 0.5}, {0.3, 0.5}, {0.3, 0.5}, {0.7, 0.5}});
    REQUIRE(found.size() == 2);
    CHECK(found[0].kind == Kind::enter);
    CHECK(found[0].id == 7);
    CHECK(found[0].at.captured_us == Film::moment(2).captured_us);
    CHECK(found[1].kind == Kind::leave);
    CHECK(found[1].at.captured_us == Film::moment(5).captured_us);
    CHECK(found[1].dwell == doctest::Approx(0.3));
    CHECK_FALSE(found[1].lost);
    const Zone& zone = film.counter.zones()[0];
    CHECK(zone.entered == 1);
    CHECK(zone.left == 1);
    CHECK(zone.present.empty());
}

TEST_CASE("counter: a track that flickers at an outline and a line counts once, and often without margin")
{
    const std::vector<Point> flicker{{0.6, 0.5},   {0.497, 0.5}, {0.503, 0.5}, {0.496, 0.5},
                                     {0.504, 0.5}, {0.45, 0.5},  {0.503, 0.5}, {0.497, 0.5}};
    Film film(left_half, middle);
    film.path(1, flicker);
    CHECK(film.counter.zones()[0].entered == 1);
    CHECK(film.counter.zones()[0].left == 0);
    CHECK(film.counter.lines()[0].in + film.counter.lines()[0].out == 1);
    Film without(left_half, middle);
    without.counter.margin = 0;
    without.path(1, flicker);
    CHECK(without.counter.zones()[0].entered > 2);
    CHECK(without.counter.lines()[0].in + without.counter.lines()[0].out > 2);
}

TEST_CASE("counter: from the left to the right of the line is in, back is out")
{
    Film film("", level);
    const auto found = film.path(1, {{0.5, 0.3}, {0.5, 0.48}, {0.5, 0.7}, {0.5, 0.2}});
    REQUIRE(found.size() == 2);
    CHECK(found[0].right);
    CHECK(found[0].at.captured_us == Film::moment(3).captured_us);
    CHECK_FALSE(found[1].right);
    CHECK(film.counter.lines()[0].in == 1);
    CHECK(film.counter.lines()[0].out == 1);
    Film swapped("", "level: 0.8,0.5 0.2,0.5");
    swapped.path(1, {{0.5, 0.3}, {0.5, 0.7}});
    CHECK(swapped.counter.lines()[0].out == 1);
}

TEST_CASE("counter: passing outside of the ends of a line does not count, coming back through it does")
{
    Film film("", level);
    CHECK(film.path(1, {{0.1, 0.3}, {0.1, 0.7}, {0.5, 0.7}}).empty());
    CHECK(film.path(1, {{0.5, 0.3}}).size() == 1);
    CHECK(film.counter.lines()[0].out == 1);
    Film slow("", level);  // passes beside the end within the margin, and moves along before it is beyond
    CHECK(slow.path(1, {{0.15, 0.45}, {0.15, 0.498}, {0.15, 0.504}, {0.25, 0.504}, {0.25, 0.6}}).empty());
}

TEST_CASE("counter: a track that ends inside leaves when it was last seen")
{
    Film film(left_half, "");
    film.counter.hold = 1.05;
    film.path(1, {{0.2, 0.5}, {0.2, 0.5}});
    std::vector<Occurrence> found;
    for (int i = 0; i < 12; ++i) {
        CHECK(film.counter.zones()[0].present.size() == (i < 11 ? 1 : 0));
        for (const auto& one : film.frame({}))
            found.push_back(one);
    }
    REQUIRE(found.size() == 1);
    CHECK(found[0].lost);
    CHECK(found[0].at.captured_us == Film::moment(2).captured_us);
    CHECK(found[0].dwell == doctest::Approx(0.1));
}

TEST_CASE("counter: gaps shorter than hold, and predicted places, change nothing")
{
    Film film(left_half, middle);
    film.path(1, {{0.2, 0.5}});
    for (int i = 0; i < 5; ++i)
        CHECK(film.frame({}).empty());
    for (int i = 0; i < 30; ++i)
        CHECK(film.frame({{.id = 1, .anchor = {0.9, 0.5}, .seen = false}}).empty());
    CHECK(film.path(1, {{0.3, 0.5}}).empty());
    CHECK(film.counter.zones()[0].entered == 1);
}

TEST_CASE("counter: a foot on the border of the image is inside a zone that reaches it")
{
    Film film(left_half, "");
    CHECK(film.path(1, {{0.2, 1}}).size() == 1);
    CHECK(film.path(2, {{0, 1.02}}).size() == 1);
}

TEST_CASE("counter: boxes without id count for the occupancy alone")
{
    Film film(left_half, middle);
    CHECK(film.frame({{.anchor = {0.2, 0.5}}, {.anchor = {0.3, 0.5}}, {.anchor = {0.8, 0.5}}}).empty());
    CHECK(film.counter.zones()[0].unnumbered == 2);
    CHECK(film.counter.zones()[0].entered == 0);
    film.frame({});
    CHECK(film.counter.zones()[0].unnumbered == 0);
}

TEST_CASE("counter: a restart, or a time that goes back, ends all tracks and keeps the counts")
{
    Film film(left_half, middle);
    film.path(1, {{0.2, 0.5}});
    const auto found = film.counter.next({0, 5}, 4.0 / 3, {{.id = 1, .anchor = {0.8, 0.5}}});
    REQUIRE(found.size() == 1);
    CHECK(found[0].lost);
    CHECK(film.counter.lines()[0].in + film.counter.lines()[0].out == 0);
    CHECK(film.counter.zones()[0].entered == 1);
}

TEST_CASE("counter: unchanged shapes keep their counts, changed ones start at 0")
{
    Film film(left_half + "; low: 0,0.5 1,0.5 1,1 0,1", middle);
    film.path(1, {{0.8, 0.6}, {0.2, 0.6}});
    film.counter.arrange(read_zones("low: 0,0.6 1,0.6 1,1 0,1; " + left_half), read_lines("middle: 0.5,0 0.5,1"));
    CHECK(film.counter.zones()[0].entered == 0);
    CHECK(film.counter.zones()[1].entered == 1);
    CHECK(film.counter.zones()[1].present.contains(1));
    CHECK(film.counter.lines()[0].in == 0);
    CHECK(film.path(1, {{0.2, 0.4}}).empty());
}
