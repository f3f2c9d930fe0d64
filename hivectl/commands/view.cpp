// hivectl view: shows the images of a drone while the command runs.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "run/launch.hpp"
#include "words/targets.hpp"

#include <hive/http/pass.hpp>

#include <algorithm>
#include <cstdlib>

namespace hivectl::view_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::string from, encoding;
    int port = 0;
    bool stay = false;
};

void require_somewhere(const Options& options)
{
    const char* display = std::getenv("DISPLAY");
    if (options.port == 0 && (!display || !*display))
        throw hive::Error(hive::Errc::refused, "no display for a window", "use a browser: --http PORT");
}

/// Makes the drone serve its page, and returns the address for a browser; empty if there is a window instead. The token
/// goes to the drone over its socket, because every user can read command lines.
std::string serve(const Options& options, hive::Application& application, const std::string& viewer)
{
    if (options.port == 0)
        return "";
    const auto token = hive::http::Pass::draw_token();
    application.set(viewer, {{"http", options.port}, {"token", token}});
    return "http://127.0.0.1:" + std::to_string(options.port) + "/?token=" + token;
}

void report(const std::string& url, const hive::Endpoint& output, const std::string& viewer, bool json)
{
    if (json)
        write_out(
            Row{{"from", to_text(output)}, {"drone", viewer}, {"url", url.empty() ? hive::Json() : hive::Json(url)}}
                .json()
            + "\n");
    else if (!url.empty())
        write_out(url + "\n");
}

/// Has the last image been shown?
bool all_shown(hive::Application& application, const std::string& viewer)
{
    const auto answer = application.status(std::vector{viewer}).at(0);
    const auto shown = [](const hive::InputStatus& input) {
        return input.why == hive::Reason::source_ended && input.queued == 0 && input.in_hand == 0;
    };
    const auto* status = value_of(answer.status);
    return status && !status->inputs.empty() && std::ranges::all_of(status->inputs, shown);
}

/// Until Ctrl-C, until the drone exits because its window was closed, or until the last image has been shown.
int look(const Options& options, hive::TiedDrone& viewer, hive::Application& application)
{
    constexpr auto between_asking = 500ms;
    auto next = std::chrono::steady_clock::now() + between_asking;
    while (interrupt::sleep(100ms)) {
        if (const auto how = viewer.exited(); how && how->code() == hive::Errc::stopped)
            return exit_code::done;
        else if (how)
            throw *how;
        if (options.stay || std::chrono::steady_clock::now() < next)
            continue;
        if (all_shown(application, viewer.name()))
            return exit_code::done;
        next = std::chrono::steady_clock::now() + between_asking;
    }
    return interrupt::exit_code();
}

int run(const Options& options, Session& session)
{
    require_somewhere(options);
    auto& application = session.application();
    const auto output = output_named(application, options.from, "image/");
    const interrupt::Deferred deferred;
    auto viewer = start_for_verb(
        session, "view", {.name = "viewer", .kind = "view", .set = {{"window", options.port == 0 ? "on" : "off"}}});
    const auto url = serve(options, application, viewer.name());
    hive::ConnectionOptions connection;
    connection.first_frame = true;
    connection.encoding = options.encoding;
    application.connect(output, {viewer.name(), "image"}, connection);
    report(url, output, viewer.name(), session.json);
    return look(options, viewer, application);
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.from, "drone or drone.output; omit the output if only one sends images").required();
    line.option("--http", options.port, "serve it to browsers on this machine at this port instead of a window")
        .type_name("PORT")
        .between(1, 65535);
    line.flag("--stay", options.stay, "keep showing the last image after the source has ended");
    line.option(
            "--encoding", options.encoding,
            "image encoding: raw, png, jpeg or jpeg:QUALITY (default: unchanged on one machine, jpeg across a network)")
        .type_name("NAME")
        .encoding();
}

}  // namespace

Verb verb()
{
    return {.name = "view",
            .group = "results",
            .usage = "NAME[.OUTPUT] [--http PORT] [options]",
            .summary = "Shows the images of a drone in a window or a browser",
            .details = "Runs a drone of kind view until Ctrl-C, until its window is closed (or q is pressed), or until "
                       "the source ends. With --http it prints the address to open in a browser on this machine.",
            .examples = "hivectl view camera\n"
                        "hivectl view face.annotated --http 8080",
            .timeout = "give up if the drone does not answer in time (default 10)",
            .operands = {Operand::sender},
            .declare = with(declare, run)};
}

}  // namespace hivectl::view_verb
