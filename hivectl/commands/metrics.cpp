// hivectl metrics: prints or serves the swarm's metrics for Prometheus.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "run/metrics_site.hpp"
#include "words/file_text.hpp"
#include "words/places.hpp"

#include <hive/http/server.hpp>
#include <hive/metrics.hpp>

#include <algorithm>
#include <charconv>

namespace hivectl::metrics_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::string form = "prometheus", http, token_file;
    std::vector<std::string> places;
    bool insecure = false;
};

/// "9464", "0.0.0.0:9464", "[::]:9464"
hive::http::Server::Settings listening(const std::string& text)
{
    hive::http::Server::Settings settings{.connections = 8};
    const auto colon = text.rfind(':');
    const auto port = text.substr(colon == std::string::npos ? 0 : colon + 1);
    if (colon != std::string::npos)
        settings.bind = text.substr(0, colon);
    if (settings.bind.starts_with('[') && settings.bind.ends_with(']'))
        settings.bind = settings.bind.substr(1, settings.bind.size() - 2);
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), settings.port);
    if (error != std::errc() || end != port.data() + port.size() || settings.port < 0 || settings.port > 65535)
        throw hive::Error(hive::Errc::invalid_argument, "invalid address \"" + text + "\"",
                          "write PORT or ADDRESS:PORT, for example 9464");
    return settings;
}

/// The token: the first line of the file.
std::string token_in(const std::string& file)
{
    constexpr std::size_t max_bytes = 4096;
    const auto text = text_of_file(file, max_bytes);
    const auto token = text.substr(0, text.find_first_of("\r\n"));
    if (token.empty())
        throw hive::Error(hive::Errc::invalid_argument, "no token in the first line of " + file,
                          "make one: openssl rand -hex 16 > " + file);
    return token;
}

void require_safe(const hive::http::Server::Settings& settings, const Options& options)
{
    if (settings.token.empty() && !options.insecure && !hive::http::Address(settings.bind, settings.port).loopback())
        throw hive::Error(hive::Errc::refused, settings.bind + " is reachable from other machines",
                          "let scrapers authenticate with --token-file FILE, or let all read with --insecure");
}

int serve(const Options& options, hive::Application& application)
try {
    auto settings = listening(options.http);
    if (!options.token_file.empty())
        settings.token = token_in(options.token_file);
    require_safe(settings, options);
    const interrupt::Deferred deferred;
    MetricsSite site(application, settings.token.empty());
    const hive::http::Server server(settings, site);
    complain("metrics", "serving " + hive::http::url_of(settings.bind, server.port()) + "metrics");
    while (interrupt::sleep(1h)) {
    }
    return interrupt::exit_code();
} catch (const hive::Error&) {
    throw;
} catch (const std::runtime_error& error) {  // the server cannot listen
    throw hive::Error(hive::Errc::io, error.what());
}

/// "camera=tcp://camera:7700"; unlike hivectl place add, without asking whether it answers yet.
hive::Place place_in(const std::string& text)
{
    const auto equals = text.find('=');
    if (equals == std::string::npos)
        throw hive::Error(hive::Errc::invalid_argument, "invalid place \"" + text + "\"",
                          "write NAME=ADDRESS, for example camera=tcp://cam1:7700");
    const auto address = text.substr(equals + 1);
    return {.drone = text.substr(0, equals), .host = host_of(address), .address = address};
}

int run(const Options& options, Session& session)
{
    auto& application = session.application(1s);
    std::vector<hive::Place> places;
    std::ranges::transform(options.places, std::back_inserter(places), place_in);
    if (!places.empty())
        application.replace_places(places);
    if (!options.http.empty())
        return serve(options, application);
    const auto form = options.form == "openmetrics" ? hive::MetricsForm::openmetrics : hive::MetricsForm::prometheus;
    const auto metrics = hive::metrics(application);
    write_out(session.json ? json_text(hive::to_json(metrics)) + "\n" : hive::to_text(metrics, form));
    return exit_code::done;
}

void declare(CommandLine& line, Options& options)
{
    const auto form =
        line.option("--as", options.form, "prometheus (default) or openmetrics; over HTTP the scraper chooses")
            .type_name("FORM")
            .one_of({"prometheus", "openmetrics"});
    const auto http =
        line.option("--http", options.http, "serve /metrics at PORT of this machine, or at ADDRESS:PORT, until Ctrl-C")
            .type_name("PORT")
            .excludes(form);
    const auto token = line.option("--token-file", options.token_file,
                                   "file whose first line is the bearer token that scrapers must send")
                           .type_name("FILE")
                           .needs(http);
    line.flag("--insecure", options.insecure,
              "allow scrapes without a token from every machine that can reach the address")
        .needs(http)
        .excludes(token);
    line.option("--place", options.places, "add the address of a drone on another machine, as hivectl place add does")
        .type_name("NAME=ADDRESS")
        .one_each();
}

}  // namespace

Verb verb()
{
    return {
        .name = "metrics",
        .group = "errors",
        .usage = "[--as FORM | --http [ADDRESS:]PORT] [options]",
        .summary = "Prints the counters of the swarm, or serves them to Prometheus",
        .details =
            "Queries all drones that hivectl ps lists, and prints one sample per counter and state: events by output, "
            "connection, group and input, with their outcomes, busy time, exceptions, ages. A drone that does not "
            "answer, or crashed, has hive_drone_up 0. The format is Prometheus 0.0.4 or OpenMetrics 1.0.0.\n\n"
            "With --http, the drones are queried at each scrape. On this machine only (the default) no token is "
            "needed; at other addresses scrapers send the token in --token-file, as set in prometheus.yml under "
            "authorization: credentials_file. The connection is not encrypted. Alerting rules and a Grafana dashboard "
            "are installed in share/hive.",
        .examples = "hivectl metrics | grep hive_drone_up\n"
                    "hivectl metrics --http 9464\n"
                    "hivectl metrics --http 0.0.0.0:9464 --token-file metrics.token",
        .timeout = "how long to wait for the answer of a drone (default 1)",
        .operands = {},
        .declare = with(declare, run)};
}

}  // namespace hivectl::metrics_verb
