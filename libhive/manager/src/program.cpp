// Finds hive-KIND in the directories, and queries its interface.
#include "last_line.hpp"
#include "python_file.hpp"

#include <hive/error.hpp>
#include <hive/name.hpp>
#include <hive/process.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <unistd.h>

namespace hive {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view program_prefix = "hive-";

/// Each is a Debian package of its own, hive-KIND; tests/install/packages.sh compares them.
constexpr std::array<std::string_view, 13> packaged{"annotate", "axis",    "background", "camera", "detect",
                                                    "face",     "gesture", "record",     "replay", "track",
                                                    "view",     "write",   "zones"};

std::vector<fs::path> directories()
{
    std::error_code ignored;
    std::vector<fs::path> result;
    if (const auto self = fs::read_symlink("/proc/self/exe", ignored); !self.empty())
        result.push_back(self.parent_path());
    for (const char* variable : {"HIVE_DRONE_PATH", "PATH"})
        if (const char* value = std::getenv(variable)) {
            std::istringstream list(value);
            for (std::string directory; std::getline(list, directory, ':');)
                if (!directory.empty())
                    result.push_back(fs::absolute(directory));
        }
    return result;
}

}  // namespace

std::optional<fs::path> program_of(const std::string& kind)
{
    for (const auto& directory : directories())
        if (const auto file = directory / (std::string(program_prefix) + kind); is_program(file))
            return file;
    return std::nullopt;
}

std::vector<std::string> kinds()
{
    std::set<std::string> found;
    std::error_code ignored;
    for (const auto& directory : directories()) {
        std::ifstream unlisted(directory / ".hive-unlisted");  // such as drones of tests; they can still be started
        const std::set<std::string> hidden{std::istream_iterator<std::string>(unlisted), {}};
        for (const auto& entry : fs::directory_iterator(directory, ignored))
            if (const auto name = entry.path().filename().string();
                name.starts_with(program_prefix) && is_program(entry.path()))
                if (const auto kind = name.substr(program_prefix.size()); !hidden.contains(kind))
                    found.insert(kind);
    }
    return {found.begin(), found.end()};
}

std::optional<std::string> kind_by_name(const std::string& drone)
{
    const auto dash = drone.rfind('-');
    const bool numbered =
        dash != std::string::npos && drone.find_first_not_of("0123456789", dash + 1) == std::string::npos;
    for (const auto& kind : {drone, numbered ? drone.substr(0, dash) : ""})
        if (!kind.empty() && program_of(kind))
            return kind;
    return std::nullopt;
}

std::string start_command(const std::string& kind, const std::string& drone)
{
    return "hivectl start " + kind + (kind == drone ? "" : " --as " + drone);
}

std::string usual_name(const std::string& kind) { return is_python_file(kind) ? fs::path(kind).stem().string() : kind; }

namespace {

DroneCommand bare_command_of(const std::string& kind)
{
    if (is_python_file(kind))
        return command_of_python_file(kind);
    require_name(kind, "kind");
    if (const auto program = program_of(kind))
        return {.program = *program, .arguments = {}, .environment = {}};
    const auto known = kinds();
    std::string list;
    for (const auto& one : known)
        list += (list.empty() ? "" : ", ") + one;
    throw no_such("there is no drone hive-" + kind + " beside " + program_invocation_short_name
                      + ", in $HIVE_DRONE_PATH or in $PATH; kinds found: " + (list.empty() ? "none" : list),
                  kind, known,
                  std::ranges::count(packaged, kind) ? "install its package: apt install hive-" + kind
                                                     : "see what can be started: hivectl start --help");
}

}  // namespace

/// A wrapper or a Python file does not report what it was started as. Later commands may run in another directory.
DroneCommand command_of(const std::string& kind)
{
    auto command = bare_command_of(kind);
    command.environment.push_back("HIVE_KIND="
                                  + (is_python_file(kind) ? fs::absolute(kind).lexically_normal().string() : kind));
    return command;
}

Interface interface_of(const std::string& kind, std::chrono::milliseconds limit)
{
    const auto command = command_of(kind);
    std::vector<std::string> words{command.program.string()};
    words.insert(words.end(), command.arguments.begin(), command.arguments.end());
    words.emplace_back("--describe");
    const auto result = run_command(words, limit, command.environment);
    std::string look = "see all that it prints:";
    for (const auto& word : words)
        look += " " + word;
    if (result.late)
        throw Error(Errc::timeout, kind + " --describe has not answered in time", look);
    if (result.exit_code != 0)
        throw Error(Errc::failed,
                    kind + " --describe ended with exit code " + std::to_string(result.exit_code) + ": "
                        + last_line(result.err),
                    look);
    try {
        return interface_from_json(parse_json(result.out));
    } catch (const Error& error) {
        throw Error(Errc::failed, kind + " --describe does not print an interface: " + error.what(), look);
    }
}

namespace {

/// The running drone has the absolute path; this one may be relative to a directory of another machine.
bool is_same_file(const std::string& running, const std::string& kind)
{
    const auto path = fs::path(kind).lexically_normal();
    fs::path end;  // after any leading ".."
    for (const auto& part : path.relative_path())
        if (part != "..")
            end /= part;
    return running == path || running == fs::absolute(path).lexically_normal()
           || (path.is_relative() && running.ends_with("/" + end.string()));
}

}  // namespace

bool is_of_kind(const Status& running, const std::string& kind)
{
    if (running.order && !running.order->kind.empty())
        return running.order->kind == kind || (is_python_file(kind) && is_same_file(running.order->kind, kind));
    return running.kind == kind || (is_python_file(kind) && interface_of(kind).kind == running.kind);
}

}  // namespace hive
