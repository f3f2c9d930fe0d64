#include "orders.hpp"

#include "jpeg.hpp"
#include "run/interrupt.hpp"
#include "run/kept_inputs.hpp"
#include "words/places.hpp"

#include <hive/advise.hpp>
#include <hive/explain.hpp>
#include <hive/name.hpp>
#include <hive/printable.hpp>
#include <hive/process.hpp>
#include <hive/rerun.hpp>
#include <hive/start.hpp>

#include <algorithm>

namespace hivectl::dash {
namespace {

using hive::Application, hive::Json;
using namespace std::chrono_literals;

hive::Endpoint end_of(const std::string& text)
{
    auto end = hive::parse_endpoint(text);
    if (end.port.empty())
        throw hive::Error(hive::Errc::invalid_argument, hive::in_quotes(text) + " is not DRONE.PORT");
    return end;
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
/// @param place  nothing: it does not run
void add_log(Json& answer, Application& application, const std::string& drone, const std::optional<hive::Place>& place)
{
    constexpr std::size_t lines = 40;
    const auto file = application.home() / (drone + ".log");
    if (place && is_elsewhere(*place))
        answer["log_problem"] = "It runs on " + place->host + ". Read its log with: hivectl logs " + drone;
    else if (auto text = hive::last_lines(file, lines); !text.empty())
        answer["log"] = std::move(text);
    else
        answer["log_problem"] = "It has written no log here.";
}

bool is_image(const hive::Event& event) { return event.type.starts_with("image/"); }

/// Newest first.
Json failures_of(Application& application, const std::string& drone)
{
    Json rows = Json::array();
    for (const auto& failure : application.failures(drone)) {
        auto row = Json::parse(failure_row(failure).json());
        row["image"] = std::ranges::any_of(failure.inputs, is_image);
        row["inputs"] = to_json(failure).at("inputs");
        for (auto& input : row["inputs"])
            input["header"] = hive::shortened(hive::to_text(input.at("header")));
        rows.insert(rows.begin(), std::move(row));
    }
    return rows;
}

/// "face" of "face@cam1".
std::string name_in(const std::string& drone) { return hive::require_name(drone.substr(0, drone.find('@')), "drone"); }

/// Where the drone runs; nothing: nowhere, and it has left a log.
std::optional<hive::Place> place_of(Application& application, const std::string& drone)
try {
    return application.place(drone);
} catch (const hive::Error& error) {
    if (error.code() != hive::Errc::not_found
        || !std::filesystem::exists(application.home() / (name_in(drone) + ".log")))
        throw;
    return std::nullopt;
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
        const auto name = name_in(drone);
        const auto place = place_of(application, drone);
        Json answer = Json::object();
        if (place)
            answer = {{"interface", to_json(application.describe(drone))}, {"values", application.get(drone)}};
        answer["failures"] = failures_of(application, name);
        add_log(answer, application, name, place);
        return answer;
    };
}

Errands::Work image_of(std::string drone, std::int64_t number)
{
    constexpr int width = 640;
    constexpr std::size_t max_size = 16 << 20;
    return [drone = std::move(drone), number](Application& application) -> Json {
        for (const auto& failure : application.failures(name_in(drone), true)) {
            const auto input = std::ranges::find_if(failure.inputs, is_image);
            if (failure.number != number || input == failure.inputs.end())
                continue;
            auto image = image_for_page(*input, width);
            if (image.bytes.size() > max_size)
                throw hive::Error(hive::Errc::too_large, "an image of more than 16 MiB is not shown");
            return {{"type", image.type}, {"bytes", Json::binary(std::move(image.bytes))}};
        }
        throw hive::Error(hive::Errc::not_found,
                          "failure " + std::to_string(number) + " of " + drone + " has no image here");
    };
}

Errands::Work advise_of(std::string drone, const std::string& goal)
{
    return [drone = std::move(drone), goal](Application& application) {
        for (const auto wanted : {hive::Goal::fps, hive::Goal::latency})
            if (goal == hive::token(wanted))
                return to_json(hive::advise(application, {drone}, {.goal = wanted}));
        throw hive::Error(hive::Errc::invalid_argument, "there is no goal " + goal);
    };
}

Errands::Work explain_of(std::string sender, std::string receiver)
{
    return [from = std::move(sender), to = std::move(receiver)](Application& application) {
        return to_json(hive::explain(application, end_of(from), end_of(to)));
    };
}

}  // namespace hivectl::dash
