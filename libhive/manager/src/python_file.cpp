// Finding the interpreter, and the package that belongs to this program.
#include "python_file.hpp"

#include <hive/error.hpp>
#include <hive/program.hpp>

#include <cstdlib>
#include <sstream>
#include <unistd.h>

namespace hive {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view python_ending = ".py";

std::string variable(const char* name)
{
    const char* value = std::getenv(name);
    return value ? value : "";
}

fs::path interpreter()
{
    const std::string told = variable("HIVE_PYTHON"), wanted = told.empty() ? "python3" : told;
    if (wanted.find('/') != std::string::npos && is_program(wanted))
        return fs::absolute(wanted);
    std::istringstream directories(variable("PATH"));
    for (std::string directory; std::getline(directories, directory, ':');)
        if (const auto file = fs::path(directory) / wanted; !directory.empty() && is_program(file))
            return fs::absolute(file);
    throw Error(Errc::not_found, "there is no " + wanted + " in $PATH to run it",
                "install python3, or name an interpreter in $HIVE_PYTHON");
}

/// The package that belongs to this program: of the build, or of the prefix into which it was installed. That of the
/// system is known to the interpreters that may use it.
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
    return {interpreter(), {"-u", fs::absolute(kind).string()}, package_beside()};
}

}  // namespace hive
