// hivectl export: writes the running swarm as a swarm file, or for a service manager.
#include "../verbs.hpp"
#include "run/swarm_file.hpp"
#include "words/targets.hpp"

#include <hive/name.hpp>
#include <hive/program.hpp>
#include <hive/swarm.hpp>
#include <hive/swarm_export.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <set>

namespace hivectl::export_verb {
namespace {

struct Options {
    std::vector<std::string> names;
    std::string swarm, form, folder, image = "hive:latest";
    bool metrics = false;
    SwarmInput from;
};

/// The drones of the swarm with that name, or all running ones.
std::vector<std::string> drones_meant(const Options& options, const std::vector<hive::SwarmPlan>& plans,
                                      hive::Application& application, Outcome& outcome)
{
    if (!options.names.empty())
        return drones_named(application, options.names, outcome);
    for (const auto& plan : plans)
        if (plan.name == options.swarm) {
            std::vector<std::string> names;
            for (const auto& drone : plan.drones)
                names.push_back(drone.name);
            return names;
        }
    return application.drones();
}

hive::SwarmPlan running_plan(const Options& options, Session& session, Outcome& outcome)
{
    auto& application = session.application();
    // A plan that cannot be read does not keep others from being exported.
    const auto plans =
        hive::Swarm::remembered(application, [](const hive::Error& error) { complain_about("export", error); });
    const auto names = drones_meant(options, plans, application, outcome);
    const auto only = plans.size() == 1 ? plans.front().name : "swarm";
    const auto name = options.swarm.empty() ? only : options.swarm;
    return hive::Swarm::running(application, name, names);
}

/// Keeps these drones and the connections among them. A name without a match is a failure of `outcome`.
void keep_named(hive::SwarmPlan& plan, const Options& options, Outcome& outcome)
{
    const auto is_like = [](const std::string& word) {
        return [&](const hive::SwarmDrone& drone) { return hive::matches_glob(word, drone.name); };
    };
    std::vector<std::string> known;
    for (const auto& drone : plan.drones)
        known.push_back(drone.name);
    for (const auto& word : options.names)
        if (std::ranges::none_of(plan.drones, is_like(word)))
            outcome.failed(word,
                           hive::no_such("no drone matches " + hive::in_quotes(word) + " in " + options.from.file, word,
                                         known, "see its drones: hivectl export --from " + options.from.file));
    std::erase_if(plan.drones, [&](const hive::SwarmDrone& drone) {
        return std::ranges::none_of(options.names, [&](const auto& word) { return is_like(word)(drone); });
    });
    std::erase_if(plan.connections,
                  [&](const auto& each) { return !plan.drone(each.from.drone) || !plan.drone(each.to.drone); });
}

/// An engine that counts for no drone can be a mistake in a swarm file.
void drop_unused_engines(hive::SwarmPlan& plan)
{
    std::set<std::string> used;
    for (const auto& drone : plan.drones)
        if (const auto first = std::ranges::find_if(
                plan.engines, [&](const auto& engine) { return hive::matches_glob(engine.first, drone.host); });
            first != plan.engines.end())
            used.insert(first->first);
    std::erase_if(plan.engines, [&](const auto& engine) { return !used.contains(engine.first); });
}

void write_file(const std::filesystem::path& path, const hive::ExportedFile& file)
{
    std::filesystem::create_directories(path.parent_path());
    if (!(std::ofstream(path) << file.text << std::flush))
        throw hive::Error(hive::Errc::io, "cannot write " + path.string() + ": " + std::strerror(errno));
    using std::filesystem::perms;
    if (file.is_program)
        std::filesystem::permissions(path, perms::owner_exec | perms::group_exec | perms::others_exec,
                                     std::filesystem::perm_options::add);
}

/// Writes into the folder, or one file to stdout.
void write_form(const hive::SwarmPlan& plan, const Options& options, bool json)
{
    const auto programs = std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
    const hive::ExportOptions exporting{.programs = programs,
                                        .image = options.image,
                                        .metrics = options.metrics,
                                        .interface_of = [](const auto& kind) { return hive::interface_of(kind); }};
    for (const auto& note : hive::export_notes(plan, options.form, exporting))
        complain("export", note);
    const auto files = hive::export_swarm(plan, options.form, exporting);
    if (options.folder.empty() && files.size() > 1 && !json)
        throw hive::Error(hive::Errc::invalid_argument,
                          options.form + " takes " + std::to_string(files.size()) + " files",
                          "choose an output folder: --to FOLDER");
    for (const auto& file : files) {
        const auto path = std::filesystem::path(options.folder) / file.name;
        if (!options.folder.empty())
            write_file(path, file);
        if (json)
            write_out(Row{{"file", path.string()}, {"text", file.text}}.json() + "\n");
        else
            write_out(options.folder.empty() ? file.text : path.string() + "\n");
    }
}

int run(const Options& options, Session& session)
{
    Outcome outcome("export");
    hive::SwarmPlan plan;
    if (options.from.file.empty()) {
        plan = running_plan(options, session, outcome);
    } else {
        const auto reading = swarm_reading(options.from, session.timeout(std::chrono::seconds(10)));
        for (const auto& mistake : reading.mistakes)
            fail("export", hive::Errc::invalid_argument, mistake_text(options.from.file, mistake));
        if (!reading.mistakes.empty())
            return exit_code_of(hive::Errc::invalid_argument);
        plan = reading.plan;
        if (!options.names.empty())
            keep_named(plan, options, outcome);
    }
    if (!options.names.empty() && plan.drones.empty())
        return outcome.exit_code();  // `up` of an empty swarm would stop all drones of its name
    if (options.from.file.empty() && !options.form.empty() && plan.drones.empty())
        throw hive::Error(hive::Errc::not_found, "no drones to export", "start one: hivectl start KIND");
    if (!options.names.empty())
        drop_unused_engines(plan);
    if (options.form.empty())
        write_out(to_text(plan));
    else
        write_form(plan, options, session.json);
    return outcome.exit_code(exit_code::done);
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.names,
                "only these drones or globs (default: all of the swarm or the file, or all that run)");
    const auto swarm =
        line.option("--swarm", options.swarm, "the name of the swarm (default: the one that was brought up from here)")
            .type_name("NAME");
    const auto settings = declare_variables(line, options.from);
    const auto form = line.option("--as", options.form,
                                  "output format: systemd units, a compose file, Kubernetes manifests, an sbatch "
                                  "script, or a shell script of hivectl commands")
                          .type_name("FORM")
                          .one_of(hive::export_forms());
    const auto from = line.option("--from", options.from.file, "write that swarm file instead of what runs; -: stdin")
                          .type_name("FILE")
                          .excludes(swarm);
    settings.needs(from);
    line.option("--to", options.folder, "write the files of --as there, and print their names")
        .type_name("FOLDER")
        .needs(form);
    line.option("--image", options.image, "container image (default hive:latest)").type_name("NAME").needs(form);
    line.flag("--metrics", options.metrics, "with compose and kubernetes: add a container for hivectl metrics --http")
        .needs(form);
}

}  // namespace

Verb verb()
{
    return {
        .name = "export",
        .group = "a swarm from a file",
        .usage = "[NAME...] [options]",
        .summary = "Writes the running drones, parameters and connections as a swarm file",
        .details =
            "hivectl up with that file changes nothing here, and starts the same swarm elsewhere. Default parameters "
            "are omitted; passwords are not. The \"restart\" of a drone is taken from the file of the swarm that was "
            "brought up here.\n\n"
            "With --as, each drone's command line alone restores its parameters and connections, whatever starts it.",
        .examples = "hivectl export > doorway.json\n"
                    "hivectl export camera 'face-*' > faces.json\n"
                    "hivectl export --from doorway.json --as systemd --to units\n"
                    "hivectl export --from doorway.json --as compose > compose.yaml",
        .operands = {Operand::drone},
        .declare = with(declare, run)};
}

}  // namespace hivectl::export_verb
