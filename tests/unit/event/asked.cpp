// Who answers a request: somebody who took it up in time, or its deadline; never both.
#include <hive/event/link.hpp>

#include <doctest/doctest.h>

using hive::event::Asked;
using hive::event::Clock;
using hive::protocol::PacketType;

TEST_CASE("asked: what was taken up in time does not expire, and only its first answer counts")
{
    Asked asked(PacketType::set, 7, Clock::now() + std::chrono::hours(1));
    CHECK(asked.id() == 7);
    CHECK(asked.type() == PacketType::set);
    CHECK(asked.begin());
    CHECK_FALSE(asked.begin());
    CHECK_FALSE(asked.expire(Clock::now() + std::chrono::hours(2)));
    CHECK(asked.answer());
    CHECK_FALSE(asked.answer());
}

TEST_CASE("asked: what nobody took up expires once, and then nothing may be done and no other answer counts")
{
    const auto deadline = Clock::now();
    Asked asked(PacketType::set, 1, deadline);
    CHECK_FALSE(asked.begin());
    CHECK_FALSE(asked.expire(deadline - std::chrono::milliseconds(1)));
    CHECK(asked.expire(deadline));
    CHECK_FALSE(asked.expire(deadline));
    CHECK_FALSE(asked.begin());
    CHECK_FALSE(asked.answer());
}

TEST_CASE("asked: an answer that needs no taking up is in time until the deadline has answered")
{
    Asked asked(PacketType::connect, 1, Clock::now());
    CHECK(asked.answer());
    CHECK_FALSE(asked.expire(Clock::now()));
}
