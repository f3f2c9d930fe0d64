// Computes pauses, counts password attempts, and writes the condition.
#include "retry_policy.hpp"

namespace axis {
namespace {

/// Attempts without an answer burden no camera.
bool is_unreachable(Failure kind)
{
    return kind == Failure::no_route || kind == Failure::refused || kind == Failure::no_answer
           || kind == Failure::silent;
}

}  // namespace

void RetryPolicy::expect(Time now)
{
    if (!due_since_)
        due_since_ = now;
}

void RetryPolicy::frame(Time now)
{
    reset_failures();
    due_since_ = now;
}

void RetryPolicy::expect_nothing()
{
    reset_failures();
    due_since_.reset();
}

void RetryPolicy::reset_failures()
{
    backoff_.reset();
    logins_ = 0;
    last_error_.clear();
    broken_.clear();
}

void RetryPolicy::failed(const CameraError& error, Time now)
{
    if (error.kind() == Failure::login_refused)
        ++logins_;
    last_error_ = message_of(error);
    const bool unreachable = is_unreachable(error.kind());
    if (unreachable)
        backoff_.reset();
    next_try_ = now + (unreachable ? shortest : backoff_.next());
}

std::string RetryPolicy::message_of(const CameraError& error) const
{
    const std::string text = error.what();
    switch (error.kind()) {
    case Failure::silent: return broken_.empty() ? "stalled" : "stalled: " + broken_;
    case Failure::login_needed: return "auth_failed: " + text;
    case Failure::login_refused:
        return locked_out()
                   ? "auth_failed: " + text
                         + "; to retry, touch the credentials file or set credentials again, even to the same path"
                   : text + " (try " + std::to_string(logins_) + " of " + std::to_string(max_logins) + ")";
    default: return text;
    }
}

void RetryPolicy::new_credentials(Time now)
{
    logins_ = 0;
    backoff_.reset();
    next_try_ = now;
}

void RetryPolicy::retry_once(Time now)
{
    if (!locked_out())
        return;
    new_credentials(now);
    logins_ = max_logins - 1;
}

std::string RetryPolicy::condition(Time now) const
{
    if (!last_error_.empty())
        return last_error_;
    if (due_since_ && now - *due_since_ > stalled_after)
        return broken_.empty() ? "stalled" : "stalled: " + broken_;
    return "";
}

}  // namespace axis
