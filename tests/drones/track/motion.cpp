// The Kalman filter: constant speed is learned, time that passes is used as it is.
#include <doctest/doctest.h>
#include <motion.hpp>

#include <cmath>
#include <random>

using track::Motion;

TEST_CASE("motion: the speed of something that moves evenly is learned, at uneven times too")
{
    Motion motion(100, 1, 50);
    double time = 0;
    for (const double passed : {0.03, 0.04, 0.1, 0.02, 0.05, 0.2, 0.03, 0.1}) {
        time += passed;
        motion.predict(passed, 1);
        motion.correct(100 + 80 * time, 1);
    }
    CHECK(motion.speed() == doctest::Approx(80).epsilon(0.03));
    motion.predict(0.5, 1);
    CHECK(motion.place() == doctest::Approx(100 + 80 * (time + 0.5)).epsilon(0.01));
}

TEST_CASE("motion: one step of two seconds predicts what two steps of one second predict")
{
    Motion one(0, 1, 10), two(0, 1, 10);
    for (Motion* motion : {&one, &two}) {
        motion->predict(1, 0);
        motion->correct(7, 1);
    }
    one.predict(2, 0);
    two.predict(1, 0);
    two.predict(1, 0);
    CHECK(one.place() == doctest::Approx(two.place()));
    one.correct(30, 1);
    two.correct(30, 1);
    CHECK(one.place() == doctest::Approx(two.place()));
    CHECK(one.speed() == doctest::Approx(two.speed()));
}

TEST_CASE("motion: noisy places come out nearer to the truth than they went in")
{
    std::mt19937 random(4);
    std::normal_distribution<double> noise(0, 5);
    Motion motion(0, 5, 100);
    double measured_error = 0, error = 0;
    for (int i = 1; i <= 300; ++i) {
        const double truth = 3.0 * i, measured = truth + noise(random);
        motion.predict(0.1, 2);
        motion.correct(measured, 5);
        if (i > 20) {
            measured_error += std::pow(measured - truth, 2);
            error += std::pow(motion.place() - truth, 2);
        }
    }
    CHECK(error < 0.5 * measured_error);
}
