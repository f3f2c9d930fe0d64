// hivectl connect: sends the events of an output to inputs.
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../output.hpp"
#include "../session.hpp"
#include "../status_line.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

namespace hivectl::connect_verb {
namespace {

struct Options {
    std::string sender;
    std::vector<std::string> receivers;
    bool stream = false, notify = false, share = false, first_frame = false;
    int window = 1;
    std::string group, encoding;
    std::optional<double> lease_s;
};

hive::ConnectionOptions connection_of(const Options& options, const std::string& sender)
{
    hive::ConnectionOptions connection;
    connection.transfer = options.stream ? hive::Transfer::streaming : hive::Transfer::synchronized;
    connection.delivery = options.notify ? hive::Delivery::notification : hive::Delivery::data;
    connection.window = options.window;
    connection.group = options.group.empty() && options.share ? sender : options.group;
    connection.first_frame = options.first_frame;
    connection.encoding = options.encoding;
    if (options.lease_s && connection.group.empty())
        throw hive::Error(hive::Errc::invalid_argument, "--lease is for shared work", "add --share or --group NAME");
    if (options.lease_s)
        connection.lease = std::chrono::milliseconds(static_cast<std::int64_t>(*options.lease_s * 1000));
    return connection;
}

void report(const std::pair<hive::Endpoint, hive::Endpoint>& ends, const hive::ConnectionOptions& connection, bool json)
{
    const auto from = to_text(ends.first), to = to_text(ends.second);
    write_out(json ? Row{{"from", from}, {"to", to}, {"options", hive::to_json(connection)}}.json() + "\n"
                   : from + " -> " + to + "\n");
}

int run(const Options& options, Session& session)
{
    auto& application = session.application();
    const auto sender = application.endpoint(options.sender);
    application.find(sender.drone);  // one error about the sender, not one for each receiver
    const auto connection = connection_of(options, sender.drone);
    Outcome outcome("connect");
    for (const auto& receiver : endpoints_named(application, options.receivers, outcome)) {
        try {
            const Waiting waiting(to_text(receiver) + " to connect");
            report(application.connect(sender, receiver, connection), connection, session.json);
            outcome.done();
        } catch (const hive::Error& error) {
            outcome.failed(to_text(receiver), error);
        }
    }
    return outcome.exit_code();
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("SENDER", options->sender, "drone or drone.output; the output may be left out when only one fits")
        .required();
    line.option("RECEIVER", options->receivers, "drones or drone.input, one or several; globs such as 'face-*'")
        .required();
    const auto stream = line.flag("--stream", options->stream,
                                  "send every event, not only the newest when the receiver is ready; what it cannot "
                                  "keep up with is dropped and counted");
    line.option("--window", options->window,
                "how many events the receiver may ask for ahead, so that it never waits for a round trip (default 1)")
        .type_name("N")
        .between(1, 64)
        .excludes(stream);
    const auto notify = line.flag("--notify", options->notify, "send headers without bodies");
    const auto first_frame = line.flag("--first-frame", options->first_frame,
                                       "begin with the newest event that exists already; not for shared work");
    line.flag("--share", options->share,
              "the receivers share the work: each event goes to exactly one of them, the one with the fewest events in "
              "hand, or "
              "of these the one waiting longest")
        .excludes(stream)
        .excludes(notify)
        .excludes(first_frame);
    line.option("--group", options->group,
                "share with everyone of that group (default with --share: the sender's name)")
        .type_name("NAME")
        .excludes(stream)
        .excludes(notify)
        .excludes(first_frame);
    line.option("--lease", options->lease_s,
                "how long a member may work on an event before another gets it; the shortest of a group holds "
                "(default: measured)")
        .type_name("SECONDS")
        .seconds();
    line.option("--encoding", options->encoding,
                "how pictures travel: raw, png, jpeg or jpeg:QUALITY (default: as they are on one machine, jpeg across "
                "a network)")
        .type_name("NAME")
        .encoding()
        .excludes(notify);
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb verb()
{
    return {.name = "connect",
            .group = "connections",
            .usage = "SENDER[.OUTPUT] RECEIVER[.INPUT]... [options]",
            .summary = "Sends the events of one drone to others",
            .details = "Returns when both ends have confirmed the connection, and prints the ports that were "
                       "connected. By default a receiver gets the newest event each time it is ready for one, so it "
                       "never falls behind. When an end restarts, the connection is made again by itself.",
            .examples = "hivectl connect camera face\n"
                        "hivectl connect camera.image face.image --window 2\n"
                        "hivectl connect camera face --encoding jpeg:60\n"
                        "hivectl connect camera 'face-*' --share  divide the work",
            .operands = {Operand::sender, Operand::receiver},
            .declare = declare};
}

}  // namespace hivectl::connect_verb
