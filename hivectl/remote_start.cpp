// Has hivectl start or stop a drone on another machine, and keeps the list of places.
#include "remote_start.hpp"

#include "exit_code.hpp"
#include "interrupt.hpp"
#include "launch.hpp"
#include "output.hpp"
#include "places.hpp"
#include "session.hpp"
#include "status_line.hpp"
#include "table.hpp"

#include <hive/name.hpp>
#include <hive/remote.hpp>

#include <algorithm>
#include <future>
#include <optional>
#include <sstream>
#include <utility>

namespace hivectl {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> texts_in(const hive::Json& list)
{
    std::vector<std::string> texts;
    for (const auto& item : list)
        if (item.is_string())
            texts.push_back(item.get<std::string>());
    return texts;
}

/// What the drone there says when it is asked from here.
hive::StatusAnswer answer_from(hive::Application& application, const hive::Place& place)
{
    application.timeout(2s);
    return application.status(std::vector{place.drone}).at(0);
}

}  // namespace

int start_remotely(Session& session, const RemotePlan& plan)
{
    hive::require_name(plan.kind, "kind");
    auto& application = session.application();
    require_free(application, "start", plan.kind, plan.name);
    const hive::Remote remote(plan.ssh, session.home());
    const auto limit = session.timeout(10s);
    std::vector<std::string> words{"start",
                                   plan.kind,
                                   "--as",
                                   plan.name,
                                   "--json",
                                   "--timeout",
                                   std::to_string(std::max<std::int64_t>(1, limit / 1s))};
    words.insert(words.end(), plan.words.begin(), plan.words.end());
    interrupt::defer_until_exit();  // a drone that is starting there comes up even if this exits
    std::optional<Waiting> waiting(plan.name + " to be ready on " + remote.host());
    auto starting = std::async(std::launch::async, [&] { return remote.hivectl(words, limit + 12s); });
    for (bool told = false; starting.wait_for(50ms) != std::future_status::ready;)
        if (interrupt::requested() && !std::exchange(told, true))
            complain("start", "interrupted: " + plan.name + " is ended as soon as " + remote.host()
                                  + " has started it; Ctrl-C again leaves it there");
    const auto result = starting.get();
    waiting.reset();
    repeat_complaints("start", remote.host(), result.err);
    if (result.exit_code != exit_code::done)
        return interrupt::requested() ? interrupt::exit_code() : result.exit_code;
    if (interrupt::requested()) {
        const auto ended = remote.hivectl({"stop", plan.name}, limit + 12s);
        repeat_complaints("stop", remote.host(), ended.err);
        return interrupt::exit_code();
    }
    const hive::Json started = hive::parse_json(result.out);
    const auto places =
        texts_in(hive::Fields(started, "what hivectl start printed on " + remote.host()).array("places"));
    const hive::Place place{.drone = plan.name,
                            .host = remote.host(),
                            .address = remote.met_at(places, remote.address(limit)),
                            .ssh = plan.ssh};
    application.replace_places({place});
    if (const auto answer = answer_from(application, place); answer.error) {
        complain("start", plan.name + " runs on " + place.host + ", but does not answer here: "
                              + explained(*answer.error) + "; is " + place.address + " open to this machine?");
        return exit_code_of(answer.error->code());
    }
    const hive::Fields fields(started, "start");
    const Row row{{"drone", plan.name},
                  {"kind", plan.kind},
                  {"host", place.host},
                  {"pid", fields.integer_or("pid", 0, hive::max_json_integer, 0)},
                  {"log", fields.text_or("log", "")},
                  {"places", fields.array("places")},
                  {"address", place.address}};
    write_out(session.json ? row.json() + "\n" : plan.name + "\n");
    return exit_code::done;
}

int stop_remotely(Session& session, const hive::Place& place)
{
    const hive::Remote remote(place.ssh, session.home());
    const Waiting waiting(place.drone + " to exit on " + remote.host());
    const auto result = remote.hivectl({"stop", place.drone}, session.timeout() + 12s);
    repeat_complaints("stop", remote.host(), result.err);
    if (result.exit_code == exit_code::done || result.exit_code == exit_code::not_found)
        session.application().forget_place(place);
    return result.exit_code;
}

void repeat_complaints(std::string_view verb, const std::string& host, const std::string& text)
{
    const std::string own = "hivectl " + std::string(verb) + ": ";
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        complain(verb, host + ": " + printable(line.starts_with(own) ? line.substr(own.size()) : line));
}

}  // namespace hivectl
