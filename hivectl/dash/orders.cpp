#include "orders.hpp"

#include "run/interrupt.hpp"
#include "words/places.hpp"

#include <hive/explain.hpp>
#include <hive/process.hpp>
#include <hive/start.hpp>

#include <algorithm>

namespace hivectl::dash {
namespace {

using hive::Application, hive::Json;
using namespace std::chrono_literals;

hive::Endpoint end_of(const std::string& text)
{
    const auto dot = text.rfind('.');
    if (dot == std::string::npos)
        throw hive::Error(hive::Errc::invalid_argument, hive::in_quotes(text) + " is not DRONE.PORT");
    return {text.substr(0, dot), text.substr(dot + 1)};
}

/// The current options of the connection: those that the page does not name stay.
hive::ConnectionOptions present_options(Application& application, const std::string& from, const std::string& to)
{
    const auto receiver = end_of(to);
    for (const auto& input : application.status(receiver.drone).inputs)
        if (input.from == from && input.input == receiver.port)
            return input.options;
    throw hive::Error(hive::Errc::not_found, to + " is not connected to " + from);
}

hive::ConnectionOptions changed(hive::ConnectionOptions options, const Json& order)
{
    const hive::Fields fields(order, "the order");
    options.window = static_cast<int>(fields.integer_or("window", 1, 64, options.window));
    if (fields.has("transfer"))
        options.transfer = hive::from_token<hive::Transfer>(fields.text("transfer"), "transfer");
    options.encoding = fields.text_or("encoding", options.encoding);
    if (options.transfer == hive::Transfer::streaming)
        options.window = 1;
    return options;
}

Errands::Work connect(const Json& order)
{
    const hive::Fields fields(order, "the order");
    return [order, from = fields.text("from"), to = fields.text("to")](Application& application) -> Json {
        const auto options = changed(present_options(application, from, to), order);
        application.connect(end_of(from), end_of(to), options);
        return {{"options", to_json(options)}};
    };
}

Json replace(Application& application, const std::string& drone)
{
    hive::StartOptions options;
    options.drone.name = drone;
    options.cancelled = interrupt::requested;
    const auto started = hive::replace(application, options);
    return {{"before", started.before}};
}

Errands::Work order_for_drone(const std::string& what, const std::string& drone)
{
    using Do = Json (*)(Application&, const std::string&);
    static const std::map<std::string, Do> orders{
        {"halt", [](Application& application, const std::string& name) { return application.halt(name), Json({}); }},
        {"resume",
         [](Application& application, const std::string& name) { return application.resume(name), Json({}); }},
        {"stop", [](Application& application, const std::string& name) { return application.stop(name), Json({}); }},
        {"replace", replace}};
    const auto found = orders.find(what);
    if (found == orders.end())
        throw hive::Error(hive::Errc::invalid_argument, hive::in_quotes(what) + " is not an order");
    return [act = found->second, drone](Application& application) { return act(application, drone); };
}

/// For a drone of this machine that was started in the background.
void add_log(Json& answer, Application& application, const std::string& drone)
{
    constexpr std::size_t lines = 40;
    const auto place = application.place(drone);
    const auto file = application.home() / (place.drone + ".log");
    if (is_elsewhere(place))
        answer["log_problem"] = "It runs on " + place.host + ". Read its log with: hivectl logs " + drone;
    else if (auto text = hive::last_lines(file, lines); !text.empty())
        answer["log"] = std::move(text);
    else
        answer["log_problem"] = "It has written no log here.";
}

}  // namespace

Errands::Work order_in(std::string_view body)
{
    const auto order = hive::parse_json(body);
    const hive::Fields fields(order, "the order");
    const auto what = fields.text("do");
    if (what == "connect")
        return connect(order);
    const auto drone = fields.text("drone");
    if (what != "set")
        return order_for_drone(what, drone);
    return [drone, values = fields.object("values")](Application& application) -> Json {
        return {{"values", application.set(drone, values)}};
    };
}

Errands::Work ask_of(std::string drone)
{
    return [drone = std::move(drone)](Application& application) {
        Json answer{{"interface", to_json(application.describe(drone))}, {"values", application.get(drone)}};
        add_log(answer, application, drone);
        return answer;
    };
}

Errands::Work explain_of(std::string sender, std::string receiver)
{
    return [from = std::move(sender), to = std::move(receiver)](Application& application) {
        return to_json(hive::explain(application, end_of(from), end_of(to)));
    };
}

}  // namespace hivectl::dash
