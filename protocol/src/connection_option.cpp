// The table of the options of a connection, with the reader and writer of each.
#include "each.hpp"

#include <hive/connection_option.hpp>
#include <hive/encoding.hpp>
#include <hive/name.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace hive {
namespace {

using Options = ConnectionOptions;
using Type = ConnectionOption::Type;
using Lease = std::optional<std::chrono::milliseconds>;

constexpr std::array option_table{
    ConnectionOption{
        "stream", "transfer", &Options::transfer, Type::flag, "", "true or false",
        "send every event, not only the newest when the receiver is ready; excess events are dropped and counted"},
    ConnectionOption{"notify", "delivery", &Options::delivery, Type::flag, "", "true or false",
                     "send headers without bodies"},
    ConnectionOption{"window", "window", &Options::window, Type::count, "N", "a whole number from 1 to 64",
                     "number of events the receiver requests ahead, to hide the round trip (default 1)"},
    ConnectionOption{"first_frame", "first_frame", &Options::first_frame, Type::flag, "", "true or false",
                     "start with the newest existing event; not for shared work"},
    ConnectionOption{"group", "group", &Options::group, Type::name, "NAME", "a name for a group",
                     "share work within this group (default with --share: the sender's name)"},
    ConnectionOption{"lease", "lease_ms", &Options::lease, Type::duration, "SECONDS",
                     "a number of seconds from 0.05 to 86400",
                     "how long a member may work on an event before another gets it; the shortest in a group counts "
                     "(default: measured)"},
    ConnectionOption{
        "encoding", "encoding", &Options::encoding, Type::encoding, "NAME",
        "an encoding: raw, png, jpeg or jpeg:QUALITY",
        "image encoding: raw, png, jpeg or jpeg:QUALITY (default: unchanged on one machine, jpeg across a network)"},
};

constexpr std::array clash_table{ConnectionClash{"stream", "window"},     ConnectionClash{"stream", "share"},
                                 ConnectionClash{"stream", "group"},      ConnectionClash{"notify", "share"},
                                 ConnectionClash{"notify", "group"},      ConnectionClash{"notify", "encoding"},
                                 ConnectionClash{"first_frame", "share"}, ConnectionClash{"first_frame", "group"}};

/// Seconds, without a fraction if whole.
Json seconds(const Lease& lease)
{
    if (!lease)
        return nullptr;
    const auto ms = lease->count();
    return ms % 1000 == 0 ? Json(ms / 1000) : Json(static_cast<double>(ms) / 1000);
}

}  // namespace

std::span<const ConnectionOption> connection_option_table() { return option_table; }
std::span<const ConnectionClash> connection_clashes() { return clash_table; }

std::string connection_option_words()
{
    std::string list = "at=tcp://HOST:PORT, share";
    for (const auto& option : option_table)
        list += ", " + std::string(option.name) + (option.is_flag() ? "" : "=" + std::string(option.placeholder));
    return list;
}

std::string ConnectionOption::on_command_line() const
{
    auto words = "--" + std::string(name);
    std::ranges::replace(words, '_', '-');
    return words;
}

Json ConnectionOption::value(const ConnectionOptions& options) const
{
    return std::visit(Each{[&](Transfer Options::*one) { return Json(options.*one == Transfer::streaming); },
                           [&](Delivery Options::*one) { return Json(options.*one == Delivery::notification); },
                           [&](int Options::*one) {  // a stream has no window
                               return Json(options.transfer == Transfer::streaming ? Options{}.*one : options.*one);
                           },
                           [&](Lease Options::*one) { return seconds(options.*one); },
                           [&](auto one) { return Json(options.*one); }},
                      member);
}

std::string ConnectionOption::text(const ConnectionOptions& options) const
{
    const auto said = value(options);
    return said.is_string() ? said.get<std::string>() : to_text(said);
}

bool ConnectionOption::set(ConnectionOptions& options, const Json& value) const
{
    const bool yes = value.is_boolean() && value.get<bool>();
    const auto number = value.is_number() ? value.get<double>() : 0;
    const auto text = value.is_string() ? value.get<std::string>() : "";
    const auto put = [&](auto one, bool fits, auto wanted) {
        if (fits)
            options.*one = wanted;
        return fits;
    };
    return std::visit(Each{[&](Transfer Options::*one) {
                               return put(one, value.is_boolean(), yes ? Transfer::streaming : Transfer::synchronized);
                           },
                           [&](Delivery Options::*one) {
                               return put(one, value.is_boolean(), yes ? Delivery::notification : Delivery::data);
                           },
                           [&](bool Options::*one) { return put(one, value.is_boolean(), yes); },
                           [&](int Options::*one) {
                               const bool fits = number >= 1 && number <= widest_window && number == std::floor(number);
                               return put(one, fits, fits ? static_cast<int>(number) : 0);
                           },
                           [&](std::string Options::*one) {
                               const bool sound = type == Type::name ? is_name(text) : is_encoding(text);
                               return put(one, sound || value == "", text);
                           },
                           [&](Lease Options::*one) {
                               const bool fits = number >= shortest_lease_s && number <= longest_lease_s;
                               return put(one, fits, std::chrono::milliseconds(fits ? std::llround(number * 1000) : 0));
                           }},
                      member);
}

bool ConnectionOption::set_text(ConnectionOptions& options, const std::string& text) const
{
    if (std::holds_alternative<std::string Options::*>(member))
        return set(options, text);
    double number{};
    const auto* end = text.data() + text.size();
    const auto [stop, problem] = std::from_chars(text.data(), end, number);
    return problem == std::errc() && stop == end && set(options, number);
}

}  // namespace hive
