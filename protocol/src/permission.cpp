// The table of permissions.
#include <hive/protocol/permission.hpp>

#include <algorithm>
#include <array>
#include <optional>

namespace hive {

std::string_view token(Role role) noexcept
{
    switch (role) {
    case Role::viewer: return "viewer";
    case Role::member: return "member";
    case Role::owner: return "owner";
    }
    return {};
}

namespace protocol {
namespace {

using enum PacketType;

constexpr auto nobody = std::optional<Role>();
constexpr auto anyone = std::optional(Role::viewer);
constexpr auto members = std::optional(Role::member);
constexpr auto owners = std::optional(Role::owner);

/// The minimum role at which the listener and the dialer accept a packet of this type.
struct Rule {
    PacketType type;
    std::optional<Role> listener, dialer;
};

constexpr std::array table{
    Rule{hello, anyone, anyone},        Rule{ping, anyone, anyone},
    Rule{pong, anyone, anyone},         Rule{register_receiver, anyone, nobody},
    Rule{deregister, anyone, nobody},   Rule{request, anyone, nobody},
    Rule{segment, nobody, owners},  // memory is shared only over the local socket
    Rule{release, owners, nobody},      Rule{event, nobody, anyone},
    Rule{notification, nobody, anyone}, Rule{exception, nobody, anyone},
    Rule{reference, nobody, owners},    Rule{end, nobody, anyone},
    Rule{connect, members, nobody},     Rule{disconnect, members, nobody},
    Rule{set, members, nobody},         Rule{get, anyone, nobody},
    Rule{describe, anyone, nobody},     Rule{status, anyone, nobody},
    Rule{halt, members, nobody},        Rule{resume, members, nobody},
    Rule{stop, members, nobody},        Rule{put, members, nobody},
    Rule{forget, members, nobody},      Rule{confirmation, nobody, anyone},
};

std::string cell(Role role, Direction direction, PacketType type)
{
    return permits(role, direction, type) ? "yes" : "-";
}

std::string padded(std::string text, std::size_t width)
{
    text.resize(std::max(width, text.size() + 1), ' ');
    return text;
}

}  // namespace

bool permits(Role role, Direction direction, PacketType type) noexcept
{
    const auto rule = std::ranges::find(table, type, &Rule::type);
    if (rule == table.end())
        return false;
    const auto& least = direction == Direction::to_listener ? rule->listener : rule->dialer;
    return least && role >= *least;
}

std::string refusal(Role role, Direction direction, PacketType type)
{
    const std::string what(token(type));
    if (direction == Direction::to_dialer)
        return "a listener may not send " + what + " to a dialer";
    for (const auto higher : {Role::member, Role::owner})
        if (higher > role && permits(higher, direction, type))
            return "a " + std::string(token(role)) + " may not send " + what;
    return "who dialed may not send " + what;
}

std::string permission_table()
{
    constexpr std::size_t width = 14;
    constexpr std::array roles{Role::viewer, Role::member, Role::owner};
    std::string text = padded("packet", width);
    for (const auto role : roles)
        text += padded(std::string(token(role)), width) + padded("to " + std::string(token(role)), width);
    text += "\n";
    for (int number = 0; number <= 255; ++number) {
        const auto type = static_cast<PacketType>(number);
        if (token(type).empty())
            continue;
        text += padded(std::string(token(type)), width);
        for (const auto role : roles)
            text += padded(cell(role, Direction::to_listener, type), width)
                    + padded(cell(role, Direction::to_dialer, type), width);
        text += "\n";
    }
    return text;
}

}  // namespace protocol
}  // namespace hive
