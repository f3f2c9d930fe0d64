// Decides when to retry a camera, when to give up on a password, and what the condition says. Pure logic: the caller
// passes the time.
#pragma once

#include "camera_error.hpp"

#include <hive/backoff.hpp>

#include <chrono>
#include <optional>
#include <string>

namespace axis {

class RetryPolicy {
public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;

    /// An image that takes longer is missing.
    static constexpr std::chrono::milliseconds stalled_after{2000};
    /// Pause between two attempts. It stays at the minimum while nothing answers: such attempts cost the camera
    /// nothing, and it is found soon after it is back.
    static constexpr std::chrono::milliseconds shortest{500}, longest{10'000};
    /// Maximum attempts with a password; cameras lock out users who fail more often.
    static constexpr int max_logins = 3;

    explicit RetryPolicy(Time now) : next_try_(now) {}

    /// An image is due from now on.
    void expect(Time now);
    /// A complete image has arrived.
    void frame(Time now);
    /// Nothing is due, and all is well.
    void expect_nothing();
    /// Something other than a complete image has arrived.
    void broken(const std::string& reason) { broken_ = reason; }
    void failed(const CameraError& error, Time now);
    /// There are new credentials to try.
    void new_credentials(Time now);
    /// Allows one more attempt with the same ones, because cameras count. No effect unless locked out.
    void retry_once(Time now);

    [[nodiscard]] Time next_try() const { return next_try_; }
    /// The password was wrong at the last attempt.
    [[nodiscard]] bool login_refused() const { return logins_ > 0; }
    /// It was wrong so often that it is not retried.
    [[nodiscard]] bool locked_out() const { return logins_ >= max_logins; }
    /// Empty if all is well; otherwise one sentence, which starts with "stalled" or "auth_failed" in these two cases.
    [[nodiscard]] std::string condition(Time now) const;

private:
    void reset_failures();
    [[nodiscard]] std::string message_of(const CameraError& error) const;

    Time next_try_;
    hive::Backoff backoff_{shortest, longest};
    int logins_ = 0;
    std::optional<Time> due_since_;
    std::string last_error_, broken_;
};

}  // namespace axis
