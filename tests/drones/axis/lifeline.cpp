// When a camera is tried again and what is said about it; the test tells the time.
#include "lifeline.hpp"

#include <doctest/doctest.h>

using axis::CameraError;
using axis::Lifeline;
using axis::Trouble;
using namespace std::chrono_literals;

namespace {

const Lifeline::Time start{1000s};

}  // namespace

TEST_CASE("lifeline: a camera that answers wrongly is tried after 0.5 s, doubling to 10 s, anew after a picture")
{
    Lifeline line(start);
    CHECK(line.next_try() == start);
    const CameraError wrong(Trouble::refused_status, "status 503");
    for (const auto pause : {500ms, 1000ms, 2000ms, 4000ms, 8000ms, 10000ms, 10000ms}) {
        line.failed(wrong, start);
        CHECK(line.next_try() == start + pause);
    }
    line.picture(start);
    line.failed(wrong, start);
    CHECK(line.next_try() == start + 500ms);
}

TEST_CASE("lifeline: a camera that is not there or says nothing is tried every half second, so that it is found when "
          "it is back")
{
    Lifeline line(start);
    for (int i = 0; i < 5; ++i)
        line.failed(CameraError(Trouble::refused_status, ""), start);
    for (const auto trouble :
         {Trouble::refused, Trouble::no_route, Trouble::no_answer, Trouble::silent, Trouble::refused}) {
        line.failed(CameraError(trouble, ""), start);
        CHECK(line.next_try() == start + 500ms);
    }
}

TEST_CASE("lifeline: a picture that is due for more than 2 s is a stall, which ends with the next picture")
{
    Lifeline line(start);
    CHECK(line.condition(start + 1h).empty());  // nothing was expected
    line.expect(start);
    CHECK(line.condition(start + 2000ms).empty());
    CHECK(line.condition(start + 2001ms) == "stalled");
    line.picture(start + 3s);
    CHECK(line.condition(start + 3s).empty());
    line.expect(start + 4s);  // it is due since the last one
    CHECK(line.condition(start + 5500ms) == "stalled");
    line.content();
    CHECK(line.condition(start + 1h).empty());
}

TEST_CASE("lifeline: a stall says so when pictures come that are not whole")
{
    Lifeline line(start);
    line.expect(start);
    line.broken("it is cut short");
    CHECK(line.condition(start + 1s).empty());
    CHECK(line.condition(start + 3s) == "stalled: it is cut short");
    line.failed(CameraError(Trouble::silent, "x"), start);
    CHECK(line.condition(start) == "stalled: it is cut short");
    line.picture(start);
    line.failed(CameraError(Trouble::silent, "x"), start);
    CHECK(line.condition(start) == "stalled");
}

TEST_CASE("lifeline: a failure is said until a picture comes, the newest first")
{
    Lifeline line(start);
    line.expect(start);
    line.failed(CameraError(Trouble::closed, "closed"), start);
    CHECK(line.condition(start + 5s) == "closed");
    line.failed(CameraError(Trouble::refused, "refused"), start);
    CHECK(line.condition(start) == "refused");
    line.picture(start);
    CHECK(line.condition(start).empty());
}

TEST_CASE("lifeline: a password is tried three times, then not until it changes")
{
    Lifeline line(start);
    const CameraError wrong(Trouble::login_refused, "wrong password");
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

TEST_CASE("lifeline: a password that is tried no more is tried once more for each time that somebody wants it, and the "
          "text says how")
{
    Lifeline line(start);
    const CameraError wrong(Trouble::login_refused, "wrong password");
    for (int i = 0; i < 2; ++i)
        line.failed(wrong, start);
    line.once_more(start + 9s);
    CHECK(line.next_try() < start + 9s);  // it is being tried anyway
    line.failed(wrong, start);
    CHECK(line.condition(start)
          == "auth_failed: wrong password; to retry, touch the credentials file or set credentials again, even to the "
             "same path");
    for (const auto now : {start + 9s, start + 99s}) {
        line.once_more(now);
        CHECK_FALSE(line.locked_out());
        CHECK(line.login_refused());
        CHECK(line.next_try() == now);
        line.failed(wrong, now);
        CHECK(line.locked_out());
    }
}

TEST_CASE("lifeline: other failures between do not give a password more tries, a picture does")
{
    Lifeline line(start);
    const CameraError wrong(Trouble::login_refused, "wrong"), lost(Trouble::closed, "lost");
    for (const auto* error : {&wrong, &lost, &wrong, &lost, &wrong})
        line.failed(*error, start);
    CHECK(line.locked_out());
    Lifeline other(start);
    other.failed(wrong, start);
    other.failed(wrong, start);
    other.picture(start);
    other.failed(wrong, start);
    CHECK_FALSE(other.locked_out());
}

TEST_CASE("lifeline: a login that is missing is a failed authentication, but nothing that locks out")
{
    Lifeline line(start);
    for (int i = 0; i < 9; ++i)
        line.failed(CameraError(Trouble::login_needed, "set credentials"), start);
    CHECK_FALSE(line.locked_out());
    CHECK(line.condition(start) == "auth_failed: set credentials");
    CHECK(line.next_try() == start + 10s);
}
