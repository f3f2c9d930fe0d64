// Parses and checks the command line that all drones share.
#include "command_line.hpp"

#include "bounded_log.hpp"
#include "crash_trace.hpp"

#include <hive/connection_option.hpp>
#include <hive/name.hpp>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <iostream>

namespace hive {
namespace {

Json parameters_from(const std::vector<std::string>& assignments)
{
    Json parameters = Json::object();
    for (const auto& assignment : assignments) {
        const auto equals = assignment.find('=');
        if (equals == std::string::npos || equals == 0)
            throw Error(Errc::invalid_argument, "--set " + assignment + ": write it as name=value");
        parameters[assignment.substr(0, equals)] = assignment.substr(equals + 1);
    }
    return parameters;
}

/// An address for other machines: a TCP address that they can dial.
void require_advertisable(const service::ListenWish& wish)
{
    for (const auto& text : wish.advertise) {
        const auto address = service::listen_address(text);
        if (address.scheme != transport::Address::Scheme::tcp || address.is_everywhere())
            throw Error(
                Errc::invalid_argument, "--advertise " + text + ": cannot be dialed",
                "write tcp://HOST or tcp://HOST:PORT, with a host name or address that other machines can reach");
        if (wish.listen.empty())
            throw Error(Errc::invalid_argument, "--advertise " + text + " needs a port to advertise",
                        "add --listen tcp://HOST:PORT");
    }
}

void start_log(const std::string& name, const std::string& level)
{
    const auto file = event::default_home() / (name + ".log");
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("hive", std::make_shared<BoundedLog>(file)));
    spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %l %v");
    spdlog::set_level(spdlog::level::from_str(level));
}

/// The arguments that are checked later.
struct Words {
    std::vector<std::string> assignments, connections, expected;
    double take_over_s = 0;
};

/// The options of an order. The command line may have several addresses, a swarm file only one.
void declare(CLI::App& app, DroneSettings& settings, const OrderField& field)
{
    const std::string option(field.option), help(field.help);
    auto& order = settings.order;
    if (field.type == OrderField::Type::flag)
        app.add_flag(option, order.*std::get<bool DroneOrder::*>(field.member), help);
    else if (field.type == OrderField::Type::address)
        app.add_option(option, field.name == "listen" ? settings.listen.listen : settings.listen.advertise, help)
            ->type_name(std::string(field.placeholder));
    else {
        const auto text = std::get<std::string DroneOrder::*>(field.member);
        auto* const declared = app.add_option(option, order.*text, help)->type_name(std::string(field.placeholder));
        if (!field.words.empty())
            declared->check(CLI::IsMember(std::vector<std::string>(field.words.begin(), field.words.end())));
    }
}

void declare(CLI::App& app, DroneSettings& settings, Words& words)
{
    app.set_help_flag("-h,--help", "print this and exit");
    app.add_option("--name", settings.name, "name in the swarm")->capture_default_str();
    app.add_option("--set", words.assignments, "set a parameter; repeatable (see --describe)")->type_name("NAME=VALUE");
    app.add_option("--connect", words.connections,
                   "receive from this output once the sender is up, and reconnect when it is lost; repeatable. Omit "
                   "INPUT if there is only one. OPTIONs (`at`: address of a sender outside of this runtime directory): "
                       + connection_option_words())
        ->type_name("[INPUT=]DRONE.OUTPUT[,OPTION...]")
        ->allow_extra_args(false);
    app.add_option("--expect", words.expected,
                   "wait for this receiver before emitting lossless events; repeatable. Omit OUTPUT if there is only "
                   "one. `hivectl disconnect` ends the wait")
        ->type_name("[OUTPUT=]DRONE.INPUT[,group=NAME]")
        ->allow_extra_args(false);
    for (const auto& field : order_fields())
        if (!field.option.empty())
            declare(app, settings, field);
    app.add_option("--swarm", settings.swarm,
                   "its swarm, which `hivectl down` stops (default: none, or after a crash the one before)")
        ->type_name("NAME");
    app.add_option("--take-over", words.take_over_s,
                   "once ready, take over the name, parameters and connections of the running drone of this name; exit "
                   "if not ready in time (see `hivectl replace`)")
        ->type_name("SECONDS")
        ->check(CLI::Range(0.001, 86400.0));
    app.add_flag("--describe", settings.describe, "print the interface as JSON and exit");
    app.set_version_flag("--version", std::string(HIVE_VERSION));
}

/// The kind that this program was started as, such as a Python file. Programs that it starts do not inherit it.
std::string kind_started()
{
    const char* const kind = std::getenv("HIVE_KIND");
    std::string text = kind ? kind : "";
    ::unsetenv("HIVE_KIND");
    return text;
}

void check(DroneSettings& settings, const Words& words)
{
    require_name(settings.name, "drone");
    if (!settings.swarm.empty())
        require_name(settings.swarm, "swarm");
    auto& order = settings.order;
    order.kind = kind_started();
    settings.listen = {settings.listen.listen, settings.listen.advertise, order.insecure, order.key, order.no_announce};
    require_advertisable(settings.listen);
    settings.parameters = parameters_from(words.assignments);
    settings.connections = service::parse_connects(words.connections);
    settings.expected = service::expected_from(words.expected);
    if (words.take_over_s > 0)
        settings.take_over =
            event::Clock::now()
            + std::chrono::duration_cast<event::Clock::duration>(std::chrono::duration<double>(words.take_over_s));
    start_log(settings.name, settings.order.log_level.empty() ? "info" : settings.order.log_level);
    if (!settings.describe)
        service::trace_crashes(event::default_home() / (settings.name + ".crash"));
}

/// Prints an error of the command line. CLI11 would exit with its own codes, from 100 on.
Error usage_error(const CLI::App& app, const CLI::ParseError& error)
{
    const auto extras = app.remaining();
    const auto& wrong = extras.empty() ? std::string() : extras.front();
    const auto text = extras.empty()           ? error.what()
                      : wrong.starts_with('-') ? "no option " + in_quotes(wrong)
                                               : "unexpected argument " + in_quotes(wrong);
    return {Errc::invalid_argument, text, "see " + app.get_name() + " --help"};
}

}  // namespace

namespace service {

void require_sound(const ListenWish& wish)
{
    require_advertisable(wish);
    keys_for(wish);
}

std::optional<DroneSettings> read_command_line(int argc, const char* const* argv, const DroneProgram& program,
                                               int& exit_code)
{
    CLI::App app(program.summary + "\nA Hive drone, usually started by `hivectl start " + program.kind + "`.",
                 "hive-" + program.kind);
    DroneSettings settings;
    settings.name = program.kind;
    Words words;
    declare(app, settings, words);
    try {
        app.parse(argc, argv);
        check(settings, words);
        return settings;
    } catch (const CLI::Success& told) {  // --help, --version
        exit_code = app.exit(told);
    } catch (const CLI::ParseError& error) {
        exit_code = complain(program, usage_error(app, error));
    } catch (...) {
        exit_code = complain(program, current_error());
    }
    return std::nullopt;
}

int complain(const DroneProgram& program, const Error& error)
{
    std::cerr << "hive-" << program.kind << ": " << error.what()
              << (error.advice().empty() ? "" : "; " + error.advice()) << std::endl;
    return info(error.code()).exit_code;
}

}  // namespace service

int run_drone(int argc, char** argv, const DroneProgram& program, const std::function<void(Drone&)>& body)
{
    int exit_code = 0;
    auto settings = service::read_command_line(argc, argv, program, exit_code);
    if (!settings)
        return exit_code;
    try {
        DroneCore core(program, std::move(*settings));
        Drone drone(core);
        body(drone);
        return 0;
    } catch (...) {
        return service::complain(program, current_error());
    }
}

}  // namespace hive
