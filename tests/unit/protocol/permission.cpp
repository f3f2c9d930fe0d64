// The table of permissions: every role, both directions, all 256 numbers a packet type can have.
#include <hive/protocol/permission.hpp>

#include <doctest/doctest.h>

#include <set>
#include <sstream>

using namespace hive;
using namespace hive::protocol;

namespace {

using Types = std::set<std::string>;

/// What each end takes, written down a second time as SPEC.md has it; anything else is denied.
const Types both_say{"hello", "ping", "pong"};
const Types viewers_say{"register", "deregister", "request", "get", "describe", "status"};
const Types members_say{"connect", "disconnect", "set", "halt", "resume", "stop", "put", "forget"};
const Types owners_say{"release"};
const Types dialers_hear{"event", "notification", "exception", "end", "confirmation"};
const Types owners_hear{"segment", "reference"};

bool expected(Role role, Direction direction, const std::string& type)
{
    if (both_say.contains(type))
        return true;
    if (direction == Direction::to_dialer)
        return dialers_hear.contains(type) || (role == Role::owner && owners_hear.contains(type));
    return viewers_say.contains(type) || (role >= Role::member && members_say.contains(type))
           || (role == Role::owner && owners_say.contains(type));
}

}  // namespace

TEST_CASE("permissions: every cell of role, direction and packet type is as written, and what is no type is denied")
{
    int cells = 0, granted = 0;
    for (const auto role : {Role::viewer, Role::member, Role::owner})
        for (const auto direction : {Direction::to_listener, Direction::to_dialer})
            for (int number = 0; number <= 255; ++number) {
                const auto type = static_cast<PacketType>(number);
                const std::string name(token(type));
                const bool permitted = permits(role, direction, type);
                CHECK_MESSAGE(permitted == (!name.empty() && expected(role, direction, name)), token(role), " ",
                              name.empty() ? std::to_string(number) : name);
                ++cells;
                granted += permitted ? 1 : 0;
            }
    CHECK(cells == 3 * 2 * 256);
    CHECK(granted == 2 * 3 * 3 + 3 * 6 + 2 * 8 + 1 + 3 * 5 + 2);
}

TEST_CASE("permissions: every type of packet stands in the lists of this test")
{
    for (int number = 0; number <= 255; ++number)
        if (const std::string name(token(static_cast<PacketType>(number))); !name.empty()) {
            int lists = 0;
            for (const auto* list : {&both_say, &viewers_say, &members_say, &owners_say, &dialers_hear, &owners_hear})
                lists += list->contains(name) ? 1 : 0;
            CHECK_MESSAGE(lists == 1, name);
        }
}

TEST_CASE("permissions: a refusal names who may not do what")
{
    CHECK(refusal(Role::viewer, Direction::to_listener, PacketType::set) == "a viewer may not send set");
    CHECK(refusal(Role::member, Direction::to_listener, PacketType::release) == "a member may not send release");
    CHECK(refusal(Role::owner, Direction::to_listener, PacketType::event) == "who dialed may not send event");
    CHECK(refusal(Role::owner, Direction::to_dialer, PacketType::stop) == "a listener may not send stop to a dialer");
}
