// Estimates place and speed along one axis with a Kalman filter for constant speed.
#pragma once

namespace track {

/// Units of length are the caller's (px). Source: R. E. Kalman, "A new approach to linear filtering and prediction
/// problems" (1960), for a state of place and speed that white acceleration disturbs.
class Motion {
public:
    /// @param place_deviation, speed_deviation  standard deviations of the first place and of a
    ///        speed of 0
    Motion(double place, double place_deviation, double speed_deviation)
        : place_(place),
          variance_(place_deviation * place_deviation),
          speed_variance_(speed_deviation * speed_deviation)
    {
    }

    [[nodiscard]] double place() const { return place_; }
    [[nodiscard]] double speed() const { return speed_; }  ///< per second

    /// Time passes. @param acceleration  standard deviation of the unknown changes of speed, per s^2
    void predict(double seconds, double acceleration)
    {
        const double push = acceleration * seconds;
        place_ += speed_ * seconds;
        variance_ += seconds * (2 * covariance_ + seconds * speed_variance_) + push * push * seconds * seconds / 4;
        covariance_ += seconds * speed_variance_ + push * push * seconds / 2;
        speed_variance_ += push * push;
    }

    /// A place was measured, with this standard deviation (above 0).
    void correct(double measured, double deviation)
    {
        const double sum = variance_ + deviation * deviation, gain = variance_ / sum, speed_gain = covariance_ / sum,
                     surprise = measured - place_;
        place_ += gain * surprise;
        speed_ += speed_gain * surprise;
        speed_variance_ -= speed_gain * covariance_;
        covariance_ *= 1 - gain;
        variance_ *= 1 - gain;
    }

private:
    double place_, speed_ = 0;
    double variance_, covariance_ = 0, speed_variance_;
};

}  // namespace track
