// Finds an interpreter with the modules that the file imports, and the package that belongs to this program.
#include "python_file.hpp"

#include "last_line.hpp"

#include <hive/error.hpp>
#include <hive/process.hpp>
#include <hive/program.hpp>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <sstream>
#include <unistd.h>
#include <utility>

namespace hive {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view python_ending = ".py";
constexpr auto search_time = std::chrono::seconds(10);

std::string variable(const char* name)
{
    const char* value = std::getenv(name);
    return value ? value : "";
}

/// The first of this name in $PATH; a name with a slash is a path. Empty: not found.
fs::path in_path(const std::string& name)
{
    if (name.find('/') != std::string::npos)
        return is_program(name) ? fs::absolute(name) : fs::path();
    std::istringstream directories(variable("PATH"));
    for (std::string directory; std::getline(directories, directory, ':');)
        if (const auto file = fs::path(directory) / name; !directory.empty() && is_program(file))
            return fs::absolute(file);
    return {};
}

/// Each once: that of $HIVE_PYTHON alone, or those of the active environment, of $PATH and of the system. Links are
/// kept: an interpreter finds its environment by the link through which it was run.
std::vector<fs::path> interpreters()
{
    const std::string told = variable("HIVE_PYTHON"), environment = variable("VIRTUAL_ENV");
    std::vector<fs::path> wanted{in_path(told.empty() ? "python3" : told)}, found;
    if (told.empty())
        wanted.emplace_back("/usr/bin/python3");
    if (told.empty() && !environment.empty())
        wanted.insert(wanted.begin(), fs::path(environment) / "bin" / "python3");
    std::error_code ignored;
    for (const auto& file : wanted)
        if (const auto whole = fs::weakly_canonical(file.parent_path(), ignored) / file.filename();
            is_program(whole) && std::ranges::find(found, whole) == found.end())
            found.push_back(whole);
    if (found.empty())
        throw Error(Errc::not_found, "there is no " + (told.empty() ? "python3" : told) + " in $PATH to run it",
                    "install python3, or name an interpreter in $HIVE_PYTHON");
    return found;
}

/// Prints the missing modules among the imports at the top of a file; and on a second line NumPy, if it is missing and
/// the file seems to use images of Hive, which need it.
constexpr const char* search_modules = R"(
import ast, importlib.util, os, sys
sys.path[0] = os.path.dirname(sys.argv[1])
try:
    tree = ast.parse(open(sys.argv[1], "rb").read())
except (SyntaxError, ValueError):
    sys.exit()
missing = []
for place, statement in enumerate(tree.body):
    if isinstance(statement, ast.Import):
        names = [name.name for name in statement.names]
    elif isinstance(statement, ast.ImportFrom):
        names = [statement.module] if statement.level == 0 else []
    elif place == 0 and isinstance(statement, ast.Expr):
        continue
    else:
        break
    for module in [name.partition(".")[0] for name in names]:
        if module not in [*missing, *sys.modules] and not importlib.util.find_spec(module):
            missing.append(module)
print(*missing, sep=", ")
images = any(getattr(node, "attr", "") in ("image", "emit_image") for node in ast.walk(tree))
print("numpy" if images and not importlib.util.find_spec("numpy") else "")
)";

struct Objection {
    std::string text = {};  ///< empty: this interpreter can probably run the file
    bool without_images = false;
};

Objection objection(const fs::path& interpreter, const std::string& file, const std::vector<std::string>& environment)
{
    const auto result = run_command({interpreter.string(), "-c", search_modules, file}, search_time, environment);
    if (result.late || result.exit_code != 0)
        return {interpreter.string() + " does not run: " + (result.late ? "no answer" : last_line(result.err))};
    std::istringstream lines(result.out);
    std::string missing, numpy;
    std::getline(lines, missing);
    std::getline(lines, numpy);
    return {missing.empty() ? "" : interpreter.string() + " cannot import " + missing, !numpy.empty()};
}

fs::path interpreter_for(const std::string& file, const std::vector<std::string>& environment)
{
    std::string objections;
    fs::path without_images;
    for (const auto& interpreter : interpreters()) {
        const auto found = objection(interpreter, file, environment);
        if (!found.text.empty())
            objections += (objections.empty() ? "" : "; ") + found.text;
        else if (!found.without_images)
            return interpreter;
        else if (without_images.empty())
            without_images = interpreter;
    }
    if (!without_images.empty())
        return without_images;
    throw Error(Errc::not_found, fs::path(file).filename().string() + ": " + objections,
                "install what is missing, or name another interpreter in $HIVE_PYTHON");
}

/// The package that belongs to this program: of the build, or of its install prefix. Interpreters find that of the
/// system themselves.
std::vector<std::string> package_beside()
{
    std::error_code ignored;
    const auto prefix = fs::read_symlink("/proc/self/exe", ignored).parent_path().parent_path();
    const std::string more = variable("PYTHONPATH");
    if (prefix == "/usr")
        return {};
    for (const char* folder : {"python", "lib/python3/dist-packages"})
        if (fs::exists(prefix / folder / "hive" / "__init__.py", ignored))
            return {"PYTHONPATH=" + (prefix / folder).string() + (more.empty() ? "" : ":" + more)};
    return {};
}

}  // namespace

bool is_program(const fs::path& file)
{
    std::error_code ignored;
    return fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0;
}

bool is_python_file(const std::string& kind)
{
    return kind.size() > python_ending.size() && kind.ends_with(python_ending);
}

DroneCommand command_of_python_file(const std::string& kind)
{
    std::error_code ignored;
    if (!fs::is_regular_file(kind, ignored))
        throw Error(Errc::not_found, "there is no file " + kind);
    const auto file = fs::absolute(kind).string();
    auto environment = package_beside();
    auto interpreter = interpreter_for(file, environment);
    return {std::move(interpreter), {"-u", file}, std::move(environment)};
}

}  // namespace hive
