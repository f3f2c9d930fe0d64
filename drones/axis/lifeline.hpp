// Decides when to try a camera again, when to give up on a password, and what the condition says. Pure logic: the
// caller tells the time.
#pragma once

#include "trouble.hpp"

#include <hive/backoff.hpp>

#include <chrono>
#include <optional>
#include <string>

namespace axis {

class Lifeline {
public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;

    /// A picture that takes longer is missed.
    static constexpr std::chrono::milliseconds stalled_after{2000};
    /// Between two attempts. It stays at the shortest while nobody is there or nothing is said: an attempt costs the
    /// camera nothing then, and it is found soon when it is back.
    static constexpr std::chrono::milliseconds shortest{500}, longest{10'000};
    /// So often is a password tried; a camera locks users out that fail more often.
    static constexpr int most_logins = 3;

    explicit Lifeline(Time now) : next_try_(now) {}

    /// From now on a picture is due.
    void expect(Time now);
    /// It came, whole.
    void picture(Time now);
    /// Nothing is due, and all is well.
    void content();
    /// Something came that is no whole picture.
    void broken(const std::string& reason) { broken_ = reason; }
    void failed(const CameraError& error, Time now);
    /// There are other credentials: they may be tried.
    void new_credentials(Time now);
    /// Somebody wants the same ones tried again: once, because a camera counts. Without effect unless locked out.
    void once_more(Time now);

    [[nodiscard]] Time next_try() const { return next_try_; }
    /// The password was wrong when it was last tried.
    [[nodiscard]] bool login_refused() const { return logins_ > 0; }
    /// It was wrong so often that it is not tried again.
    [[nodiscard]] bool locked_out() const { return logins_ >= most_logins; }
    /// Empty when all is well; otherwise one sentence, which begins with "stalled" or "auth_failed" when it is one of
    /// these.
    [[nodiscard]] std::string condition(Time now) const;

private:
    void well();
    [[nodiscard]] std::string told(const CameraError& error) const;

    Time next_try_;
    hive::Backoff backoff_{shortest, longest};
    int logins_ = 0;
    std::optional<Time> due_since_;
    std::string trouble_, broken_;
};

}  // namespace axis
