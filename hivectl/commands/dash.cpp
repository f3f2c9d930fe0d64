// hivectl dash: shows and changes the swarm in a browser.
#include "../dash/site.hpp"
#include "../dash/token.hpp"
#include "../verbs.hpp"
#include "run/interrupt.hpp"

namespace hivectl::dash_verb {
namespace {

using namespace std::chrono_literals;

constexpr int usual_port = 7690;

int run(const int& port, Session& session)
try {
    const auto home = session.application().home();
    hive::http::Server::Settings settings{.port = port,
                                          .token = dash::lasting_token(home / "dash.token"),
                                          .cookie = "hive-dash",
                                          .allow = "GET, POST",
                                          .connections = 64,
                                          .streams = 16,
                                          .preparing = session.timeout() + 15s};  // a command may wait for another
    const interrupt::Deferred deferred;
    dash::Site site(
        {.home = home, .timeout = session.timeout(), .streams = settings.streams, .repeat = settings.repeat});
    const hive::http::Server server(settings, site);
    const auto url = hive::http::url_of(settings.bind, server.port()) + "?token=" + settings.token;
    write_out(session.json ? Row{{"url", url}}.json() + "\n" : url + "\n");
    while (interrupt::sleep(1h)) {
    }
    interrupt::exit_after(1);  // otherwise a slow request to a drone would delay the exit
    return interrupt::exit_code();
} catch (const hive::Error&) {
    throw;
} catch (const std::runtime_error& error) {  // the server cannot listen
    throw hive::Error(hive::Errc::io, error.what(), "choose another port: hivectl dash --http PORT");
}

void declare(CommandLine& line, int& port)
{
    port = usual_port;
    line.option("--http", port, "port of the page on this machine (default 7690)").type_name("PORT").between(1, 65535);
}

}  // namespace

Verb verb()
{
    return {.name = "dash",
            .group = "results",
            .usage = "[--http PORT] [options]",
            .summary = "Shows the swarm in a browser: graph, rates, live images, parameters",
            .details = "Prints the address to open in a browser on this machine, and serves it until Ctrl-C. The page "
                       "shows the graph of drones and connections, the result of hivectl audit and the first cause of "
                       "hivectl explain. For a selected drone it shows live images, parameters, rates, the result of "
                       "hivectl advise, exceptions and log, and can halt, resume, replace or stop it; for a connection "
                       "it shows the counters of both "
                       "ends, and can change window, transfer and encoding.\n\n"
                       "Anyone with the address can change the swarm. Its token is saved in dash.token in the runtime "
                       "directory, so an open page reconnects when hivectl dash is restarted. The graph needs the "
                       "package graphviz; without it the drones are listed. A live image is a receiver of its output: "
                       "a source with pace=demand and no other receiver produces for it.",
            .examples = "hivectl dash\n"
                        "hivectl dash --http 8080",
            .timeout = "how long drones may take to answer a request of the page (default 5)",
            .operands = {},
            .declare = with(declare, run)};
}

}  // namespace hivectl::dash_verb
