// When a camera is retried, and its condition; the test passes the time.
#include "retry_policy.hpp"

#include <doctest/doctest.h>

using axis::CameraError;
using axis::Failure;
using axis::RetryPolicy;
using namespace std::chrono_literals;

namespace {

const RetryPolicy::Time start{1000s};

}  // namespace

TEST_CASE("retry policy: a camera that answers wrongly is retried after 0.5 s, doubling to 10 s, reset by a frame")
{
    RetryPolicy line(start);
    CHECK(line.next_try() == start);
    const CameraError wrong(Failure::refused_status, "status 503");
    for (const auto pause : {500ms, 1000ms, 2000ms, 4000ms, 8000ms, 10000ms, 10000ms}) {
        line.failed(wrong, start);
        CHECK(line.next_try() == start + pause);
    }
    line.frame(start);
    line.failed(wrong, start);
    CHECK(line.next_try() == start + 500ms);
}

TEST_CASE(
    "retry policy: a camera that is not there or says nothing is tried every half second, so that it is found when "
    "it is back")
{
    RetryPolicy line(start);
    for (int i = 0; i < 5; ++i)
        line.failed(CameraError(Failure::refused_status, ""), start);
    for (const auto kind :
         {Failure::refused, Failure::no_route, Failure::no_answer, Failure::silent, Failure::refused}) {
        line.failed(CameraError(kind, ""), start);
        CHECK(line.next_try() == start + 500ms);
    }
}

TEST_CASE("retry policy: a frame overdue by 2 s is a stall, which ends with the next frame")
{
    RetryPolicy line(start);
    CHECK(line.condition(start + 1h).empty());  // nothing was expected
    line.expect(start);
    CHECK(line.condition(start + 2000ms).empty());
    CHECK(line.condition(start + 2001ms) == "stalled");
    line.frame(start + 3s);
    CHECK(line.condition(start + 3s).empty());
    line.expect(start + 4s);  // it is due since the last one
    CHECK(line.condition(start + 5500ms) == "stalled");
    line.expect_nothing();
    CHECK(line.condition(start + 1h).empty());
}

TEST_CASE("retry policy: a stall reports incomplete frames")
{
    RetryPolicy line(start);
    line.expect(start);
    line.broken("it is cut short");
    CHECK(line.condition(start + 1s).empty());
    CHECK(line.condition(start + 3s) == "stalled: it is cut short");
    line.failed(CameraError(Failure::silent, "x"), start);
    CHECK(line.condition(start) == "stalled: it is cut short");
    line.frame(start);
    line.failed(CameraError(Failure::silent, "x"), start);
    CHECK(line.condition(start) == "stalled");
}

TEST_CASE("retry policy: the newest failure is reported until a frame arrives")
{
    RetryPolicy line(start);
    line.expect(start);
    line.failed(CameraError(Failure::closed, "closed"), start);
    CHECK(line.condition(start + 5s) == "closed");
    line.failed(CameraError(Failure::refused, "refused"), start);
    CHECK(line.condition(start) == "refused");
    line.frame(start);
    CHECK(line.condition(start).empty());
}

TEST_CASE("retry policy: a password is tried three times, then not until it changes")
{
    RetryPolicy line(start);
    const CameraError wrong(Failure::login_refused, "wrong password");
    CHECK_FALSE(line.login_refused());
    line.failed(wrong, start);
    CHECK(line.login_refused());
    line.failed(wrong, start);
    CHECK_FALSE(line.locked_out());
    CHECK(line.condition(start) == "wrong password (try 2 of 3)");
    line.failed(wrong, start);
    CHECK(line.locked_out());
    CHECK(line.condition(start).starts_with("auth_failed: wrong password"));
    line.new_credentials(start + 9s);
    CHECK_FALSE(line.locked_out());
    CHECK(line.next_try() == start + 9s);
}

TEST_CASE("retry policy: a locked-out password is retried once for each request of an operator, and the text says how")
{
    RetryPolicy line(start);
    const CameraError wrong(Failure::login_refused, "wrong password");
    for (int i = 0; i < 2; ++i)
        line.failed(wrong, start);
    line.retry_once(start + 9s);
    CHECK(line.next_try() < start + 9s);  // it is being tried anyway
    line.failed(wrong, start);
    CHECK(line.condition(start)
          == "auth_failed: wrong password; to retry, touch the credentials file or set credentials again, even to the "
             "same path");
    for (const auto now : {start + 9s, start + 99s}) {
        line.retry_once(now);
        CHECK_FALSE(line.locked_out());
        CHECK(line.login_refused());
        CHECK(line.next_try() == now);
        line.failed(wrong, now);
        CHECK(line.locked_out());
    }
}

TEST_CASE("retry policy: other failures in between do not reset the password attempts, a frame does")
{
    RetryPolicy line(start);
    const CameraError wrong(Failure::login_refused, "wrong"), lost(Failure::closed, "lost");
    for (const auto* error : {&wrong, &lost, &wrong, &lost, &wrong})
        line.failed(*error, start);
    CHECK(line.locked_out());
    RetryPolicy other(start);
    other.failed(wrong, start);
    other.failed(wrong, start);
    other.frame(start);
    other.failed(wrong, start);
    CHECK_FALSE(other.locked_out());
}

TEST_CASE("retry policy: a login that is missing is a failed authentication, but nothing that locks out")
{
    RetryPolicy line(start);
    for (int i = 0; i < 9; ++i)
        line.failed(CameraError(Failure::login_needed, "set credentials"), start);
    CHECK_FALSE(line.locked_out());
    CHECK(line.condition(start) == "auth_failed: set credentials");
    CHECK(line.next_try() == start + 10s);
}
