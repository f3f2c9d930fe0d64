// Computes pauses, counts password attempts, and writes the condition.
#include "lifeline.hpp"

namespace axis {
namespace {

/// Attempts without an answer burden no camera.
bool absent(Trouble trouble)
{
    return trouble == Trouble::no_route || trouble == Trouble::refused || trouble == Trouble::no_answer
           || trouble == Trouble::silent;
}

}  // namespace

void Lifeline::expect(Time now)
{
    if (!due_since_)
        due_since_ = now;
}

void Lifeline::picture(Time now)
{
    well();
    due_since_ = now;
}

void Lifeline::content()
{
    well();
    due_since_.reset();
}

void Lifeline::well()
{
    backoff_.reset();
    logins_ = 0;
    trouble_.clear();
    broken_.clear();
}

void Lifeline::failed(const CameraError& error, Time now)
{
    if (error.trouble() == Trouble::login_refused)
        ++logins_;
    trouble_ = told(error);
    const bool nobody = absent(error.trouble());
    if (nobody)
        backoff_.reset();
    next_try_ = now + (nobody ? shortest : backoff_.next());
}

std::string Lifeline::told(const CameraError& error) const
{
    const std::string text = error.what();
    switch (error.trouble()) {
    case Trouble::silent: return broken_.empty() ? "stalled" : "stalled: " + broken_;
    case Trouble::login_needed: return "auth_failed: " + text;
    case Trouble::login_refused:
        return locked_out()
                   ? "auth_failed: " + text
                         + "; to retry, touch the credentials file or set credentials again, even to the same path"
                   : text + " (try " + std::to_string(logins_) + " of " + std::to_string(most_logins) + ")";
    default: return text;
    }
}

void Lifeline::new_credentials(Time now)
{
    logins_ = 0;
    backoff_.reset();
    next_try_ = now;
}

void Lifeline::once_more(Time now)
{
    if (!locked_out())
        return;
    new_credentials(now);
    logins_ = most_logins - 1;
}

std::string Lifeline::condition(Time now) const
{
    if (!trouble_.empty())
        return trouble_;
    if (due_since_ && now - *due_since_ > stalled_after)
        return broken_.empty() ? "stalled" : "stalled: " + broken_;
    return "";
}

}  // namespace axis
