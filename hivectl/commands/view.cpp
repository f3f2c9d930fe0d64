// hivectl view: looks at what a drone sends, for as long as the command runs.
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../interrupt.hpp"
#include "../launch.hpp"
#include "../output.hpp"
#include "../session.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

#include <array>
#include <cstdlib>
#include <sys/random.h>
#include <sys/wait.h>

namespace hivectl {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::string from, encoding;
    int port = 0;
};

void require_somewhere(const Options& options)
{
    const char* display = std::getenv("DISPLAY");
    if (options.port == 0 && (!display || !*display))
        throw hive::Error(hive::Errc::refused, "there is no display here for a window",
                          "look with a browser: --http PORT");
}

hive::Endpoint output_of(hive::Application& application, const std::string& from)
{
    auto output = application.endpoint(from);
    if (output.port.empty())
        output.port = usual_output(application.describe(output.drone), output.drone, "image/");
    return output;
}

std::string viewer_name(int number) { return number == 1 ? "viewer" : "viewer-" + std::to_string(number); }

LaunchPlan plan_of(const Options& options, const std::string& name)
{
    LaunchPlan plan{"view", "view", name, {}, Life::tied};
    if (options.port == 0)
        plan.arguments = {"--set", "window=on"};
    else
        plan.arguments = {"--set", "window=off"};
    return plan;
}

/// 128 bits of chance, as text.
std::string drawn_token()
{
    std::array<unsigned char, 16> chance{};
    if (::getrandom(chance.data(), chance.size(), 0) != static_cast<ssize_t>(chance.size()))
        throw hive::Error(hive::Errc::io, "the system has no random numbers");
    std::string token;
    for (const unsigned byte : chance)
        for (const unsigned digit : {byte >> 4, byte & 15})
            token += "0123456789abcdef"[digit];
    return token;
}

/// Has the page served, and returns the address that a browser has to open; empty when there is a window instead. The
/// token goes to the drone over its socket: command lines are for everybody to read.
std::string serve(const Options& options, hive::Application& application, const std::string& viewer)
{
    if (options.port == 0)
        return "";
    const auto token = drawn_token();
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

/// Until Ctrl-C, or until the drone ends because its window was closed.
int look(Launch& launch)
{
    while (interrupt::sleep(100ms))
        if (const auto status = launch.process().ended())
            return WIFEXITED(*status) && WEXITSTATUS(*status) == 0 ? exit_code::done : launch.died(*status);
    return interrupt::exit_code();
}

/// Nothing of the drone is left, whichever way this ends. The log belongs to whoever has the name.
class Removal {
public:
    Removal(Launch& launch, hive::Application& application, const std::string& name)
        : launch_(launch), application_(application), name_(name)
    {
    }
    ~Removal()
    {
        launch_.process().end();
        std::error_code ignored;
        if (!runs(application_, name_))
            std::filesystem::remove(launch_.log(), ignored);
    }
    Removal(const Removal&) = delete;
    Removal& operator=(const Removal&) = delete;

private:
    Launch& launch_;
    hive::Application& application_;
    const std::string& name_;
};

/// Throws Errc::name_taken when another drone has the name of the plan.
int show(const Options& options, const hive::Endpoint& output, const LaunchPlan& plan, Session& session)
{
    auto& application = session.application();
    Launch launch(session, plan);
    const Removal removal(launch, application, plan.name);
    if (const auto failure = launch.await(session.timeout(10s)))
        return *failure;
    application.timeout(session.timeout());
    const auto url = serve(options, application, plan.name);
    hive::ConnectionOptions connection;
    connection.first_frame = true;
    connection.encoding = options.encoding;
    application.connect(output, {plan.name, "image"}, connection);
    report(url, output, plan.name, session.json);
    return look(launch);
}

/// As the first of viewer, viewer-2, viewer-3 … that nobody has.
int run(const Options& options, Session& session)
{
    require_somewhere(options);
    const auto output = output_of(session.application(), options.from);
    const interrupt::Deferred deferred;
    for (int number = 1;; ++number)
        try {
            return show(options, output, plan_of(options, viewer_name(number)), session);
        } catch (const hive::Error& error) {
            if (error.code() != hive::Errc::name_taken)
                throw;
        }
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("NAME", options->from, "drone or drone.output; the output may be left out when only one sends pictures")
        .required();
    line.option("--http", options->port, "show it to browsers on this machine, at that port, instead of in a window")
        .type_name("PORT")
        .between(1, 65535);
    line.option("--encoding", options->encoding,
                "how pictures travel: raw, png, jpeg or jpeg:QUALITY (default: as they are on one machine, jpeg across "
                "a network)")
        .type_name("NAME")
        .encoding();
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb view_verb()
{
    return {.name = "view",
            .group = "look",
            .usage = "NAME[.OUTPUT] [--http PORT] [options]",
            .summary = "Shows the pictures that a drone sends, in a window or a browser",
            .details = "Runs a drone of the kind view until Ctrl-C, or until its window is closed (the key q closes it "
                       "too). With --http it prints the address to open in a browser on this machine.",
            .examples = "hivectl view camera\n"
                        "hivectl view face.annotated --http 8080",
            .timeout = "give up if the drone does not answer within this long (default 10)",
            .operands = {Operand::sender},
            .declare = declare};
}

}  // namespace hivectl
