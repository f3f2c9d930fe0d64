// The table of the fields of an order, and the functions that use it.
#include "each.hpp"

#include <hive/drone_order.hpp>
#include <hive/error.hpp>

#include <algorithm>
#include <array>

namespace hive {
namespace {

using namespace std::string_view_literals;
using enum OrderField::Type;
using enum OrderField::Change;

constexpr std::array restart_words{"never"sv, "on-failure"sv, "always"sv};  // in the order of Restart
constexpr std::array exception_words{"skip"sv, "halt"sv};
constexpr std::array log_levels{"debug"sv, "info"sv, "warning"sv, "error"sv, "off"sv};

constexpr std::array order_table{
    OrderField{"kind", "", kind, &DroneOrder::kind, "", {}, by_restart, "", false, ""},
    OrderField{"restart", "", word, &DroneOrder::restart, "never", restart_words, by_restart, "", false, ""},
    OrderField{"on_exception", "--on-exception", word, &DroneOrder::on_exception, "skip", exception_words, at_once,
               "skip|halt", false, "if the drone's code throws: skip the input (default), or halt until resumed"},
    OrderField{"halted",
               "--halted",
               flag,
               &DroneOrder::halted,
               "",
               {},
               at_once,
               "",
               false,
               "start halted: process nothing before `hivectl resume`, so that everything can be connected first"},
    OrderField{"listen",
               "--listen",
               address,
               &DroneOrder::listen,
               "",
               {},
               by_restart,
               "ADDRESS",
               false,
               "also listen there: tcp://HOST:PORT, or tcp://HOST for a port from 7700 on, which is kept after a "
               "crash"},
    OrderField{"advertise",
               "--advertise",
               address,
               &DroneOrder::advertise,
               "",
               {},
               by_restart,
               "ADDRESS",
               false,
               "address for other machines, if it differs from --listen: tcp://HOST or tcp://HOST:PORT"},
    OrderField{"key",
               "--key",
               file,
               &DroneOrder::key,
               "",
               {},
               by_restart,
               "FILE",
               true,
               "the swarm's key file, on the machine where the drone runs (default: $HIVE_KEY, or "
               "~/.config/hive/swarm.key)"},
    OrderField{"insecure",
               "--insecure",
               flag,
               &DroneOrder::insecure,
               "",
               {},
               by_restart,
               "",
               false,
               "let --listen accept peers without a key: only on a trusted network"},
    OrderField{"no_announce",
               "--no-announce",
               flag,
               &DroneOrder::no_announce,
               "",
               {},
               by_restart,
               "",
               false,
               "do not announce a listening drone on the local network (by DNS-SD, if there is an Avahi daemon)"},
    OrderField{"remote_operator",
               "--remote-operator",
               flag,
               &DroneOrder::remote_operator,
               "",
               {},
               by_restart,
               "",
               false,
               "let key holders set paths, URLs and logins over the network, too"},
    OrderField{"change_if_shared", "", flag, &DroneOrder::change_if_shared, "", {}, never, "", false, ""},
    OrderField{"log_level", "--log-level", word, &DroneOrder::log_level, "info", log_levels, by_restart, "LEVEL", false,
               "minimum log level: debug, info (default), warning, error or off"},
    OrderField{"cpus", "", amount, &DroneOrder::cpus, "", {}, by_restart, "", false, "", 1024},
    OrderField{"memory_mib", "", amount, &DroneOrder::memory_mib, "", {}, by_restart, "", false, "", 1 << 24},
    OrderField{"gpus", "", amount, &DroneOrder::gpus, "", {}, by_restart, "", false, "", 64},
};

}  // namespace

std::span<const OrderField> order_fields() { return order_table; }

Json OrderField::value(const DroneOrder& order) const
{
    return std::visit(
        Each{[&](Restart DroneOrder::*one) { return Json(restart_words.at(static_cast<std::size_t>(order.*one))); },
             [&](auto one) { return Json(order.*one); }},
        member);
}

Json OrderField::in_force(const DroneOrder& order) const
{
    const auto given = value(order);
    return given == "" ? Json(usual) : given;
}

bool OrderField::is_given(const DroneOrder& order) const { return in_force(order) != in_force(DroneOrder{}); }

void OrderField::copy(DroneOrder& to, const DroneOrder& from) const
{
    std::visit([&](auto one) { to.*one = from.*one; }, member);
}

void OrderField::set(DroneOrder& order, const Json& value) const
{
    const auto number = json_integer(value);
    const bool fits = type == flag     ? value.is_boolean()
                      : type == amount ? number && *number >= 0 && *number <= most
                                       : value.is_string();
    const auto text = value.is_string() ? value.get<std::string>() : "";
    const auto known = std::ranges::find(words, text);
    if (!fits || (!words.empty() && !text.empty() && known == words.end()))
        throw Error(Errc::malformed, std::string(name) + " cannot be " + to_text(value));
    std::visit(Each{[&](Restart DroneOrder::*one) {
                        order.*one = static_cast<Restart>(text.empty() ? 0 : known - words.begin());
                    },
                    [&](std::string DroneOrder::*one) { order.*one = text; },
                    [&](int DroneOrder::*one) { order.*one = static_cast<int>(*number); },
                    [&](bool DroneOrder::*one) { order.*one = value.get<bool>(); }},
               member);
}

std::vector<std::string> option_words(const DroneOrder& order)
{
    std::vector<std::string> words;
    for (const auto& field : order_table)
        if (field.option.empty() || !field.is_given(order))
            continue;
        else if (words.emplace_back(field.option); field.type != flag)
            words.push_back(field.value(order).get<std::string>());
    return words;
}

Json to_json(const DroneOrder& order)
{
    Json json = Json::object();
    for (const auto& field : order_table)
        if (field.is_given(order))
            json[field.name] = field.value(order);
    return json;
}

DroneOrder drone_order_from_json(const Json& object)
{
    DroneOrder order;
    for (const auto& field : order_table)
        if (const auto found = object.find(field.name); found != object.end())
            field.set(order, *found);
    return order;
}

}  // namespace hive
