// hivectl place: manages the addresses of drones on other machines.
#include "../verbs.hpp"
#include "words/format.hpp"
#include "words/places.hpp"
#include "words/targets.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hivectl::place_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::string action;
    std::vector<std::string> words;
};

Row row_of(const hive::Place& place)
{
    return Row{{"drone", place.drone},
               {"host", place.host},
               {"address", place.address},
               {"ssh", place.ssh.empty() ? hive::Json() : hive::Json(place.ssh)},
               {"answered_us", place.answered_us == 0 ? hive::Json() : hive::Json(place.answered_us)}};
}

int list(Session& session)
{
    std::vector<Row> rows;
    for (const auto& place : session.application().listed_places())
        rows.push_back(row_of(place));
    print_rows(session.form(),
               {{"NAME", "drone"},
                {"HOST", "host"},
                {"ADDRESS", "address"},
                {"SSH", "ssh", nullptr, nothing},
                {"ANSWERED", "answered_us", as_time}},
               rows);
    return exit_code::done;
}

/// The same run of the same drone, at a place that is already known.
std::optional<hive::Place> known_as(hive::Application& application, const hive::StatusAnswer& added)
{
    for (const auto& name : application.drones()) {
        const auto place = application.place(name);
        if (place.drone != added.place.drone || place.address == added.place.address)
            continue;
        const auto answer = application.status(std::vector{name}).at(0);
        const auto *status = value_of(answer.status), *same = value_of(added.status);
        if (status && same && status->epoch == same->epoch)
            return place;
    }
    return std::nullopt;
}

/// Only an address that answers is saved, so that typos show at once.
int add(const Options& options, Session& session)
{
    if (options.words.size() != 2)
        throw hive::Error(hive::Errc::invalid_argument, "give a name and an address",
                          "for example: hivectl place add camera tcp://cam1:7700");
    auto& application = session.application(2s);
    const hive::Place place{.drone = options.words[0], .host = host_of(options.words[1]), .address = options.words[1]};
    const bool listed = std::ranges::any_of(application.listed_places(), [&](const hive::Place& other) {
        return other.drone == place.drone && other.address == place.address;
    });
    if (!listed)
        application.add_place(place);
    const auto reference = place.drone + "@" + place.host + place.address.substr(place.address.rfind(':'));
    const auto answer = application.status(std::vector{reference}).at(0);
    const auto known = value_of(answer.status) ? known_as(application, answer) : std::nullopt;
    if (!listed && (error_of(answer.status) || known))
        application.forget_place(place);
    value_or_throw(answer.status);
    if (known)
        throw hive::Error(hive::Errc::name_taken, place.drone + " is known already, at " + place_text(*known),
                          "nothing to add");
    write_out(session.json ? row_of(place).json() + "\n" : place.drone + " " + place_text(place) + "\n");
    return exit_code::done;
}

std::vector<hive::Place> meant_by(const std::string& word, hive::Application& application)
{
    std::vector<hive::Place> meant;
    std::vector<std::string> names;
    for (const auto& place : application.listed_places()) {
        names.push_back(place.drone);
        if (hive::matches_glob(word, place.drone) || hive::matches_glob(word, place.drone + "@" + place.host))
            meant.push_back(place);
    }
    if (meant.empty())
        throw hive::no_such("there is no " + hive::in_quotes(word) + " in the list of places", word, names,
                            "see it: hivectl place list");
    return meant;
}

int remove(const Options& options, Session& session)
{
    if (options.words.empty())
        throw hive::Error(hive::Errc::invalid_argument, "no name is given", "see them: hivectl place list");
    auto& application = session.application();
    Outcome outcome("place");
    for (const auto& word : options.words)
        outcome.request(word, [&] {
            for (const auto& place : meant_by(word, application)) {
                application.forget_place(place);
                write_out(session.json ? row_of(place).json() + "\n" : place.drone + "\n");
            }
        });
    return outcome.exit_code();
}

int run(const Options& options, Session& session)
{
    if (options.action == "list" && !options.words.empty())
        throw hive::Error(hive::Errc::invalid_argument, "place list takes no names");
    return options.action == "list"  ? list(session)
           : options.action == "add" ? add(options, session)
                                     : remove(options, session);
}

void declare(CommandLine& line, Options& options)
{
    line.option("ACTION", options.action, "add, list or remove").required().one_of({"add", "list", "remove"});
    line.option("WORD", options.words, "for add: a name and an address; for remove: names, NAME@HOST, or globs");
}

}  // namespace

Verb verb()
{
    return {.name = "place",
            .group = "run drones",
            .usage = "add NAME ADDRESS | list | remove NAME...",
            .summary = "Manages the addresses of drones on other machines",
            .details = "hivectl start --on adds its drones, and stop removes them. Others are added with their "
                       "listening address; every verb then finds them by name. An address is saved only if the drone "
                       "answers there. If several drones have one name, NAME@HOST picks one.",
            .examples = "hivectl place list\n"
                        "hivectl place list --json | jq -r '.[].address'",
            .timeout = "how long to wait for the added drone (default 2)",
            .table = true,
            .operands = {Operand::other, Operand::drone},
            .declare = with(declare, run)};
}

}  // namespace hivectl::place_verb
