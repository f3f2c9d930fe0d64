// Looks in the store of this machine, in a file, or over ssh in the store of another machine.
#include "child.hpp"
#include "directory.hpp"
#include "known_program.hpp"
#include "own_directory.hpp"

#include <hive/event/failure_file.hpp>
#include <hive/name.hpp>
#include <hive/printable.hpp>
#include <hive/process.hpp>
#include <hive/program.hpp>
#include <hive/remote.hpp>
#include <hive/rerun.hpp>
#include <hive/version.hpp>

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <sstream>

namespace hive {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::string_view extension = ".failure";

/// A file may come from anyone, so it must not name a program of its own. Its version marks it as a file.
KeptFailure checked(KeptFailure failure)
{
    if (is_python_file(failure.kind) || (!failure.kind.empty() && !is_name(failure.kind)))
        failure.kind = {};
    if (failure.kind.empty())
        failure.kind = kind_by_name(failure.drone).value_or("");
    if (failure.version.empty())
        failure.version = "unknown";
    return failure;
}

KeptFailure in_file(const fs::path& file, const std::string& called)
try {
    return checked(event::read_failure(file, true));
} catch (const Error& error) {
    throw error.reworded((error.code() == Errc::io ? "cannot read " + called : called + " is not a whole kept failure")
                         + ": " + error.what());
}

/// The file that ssh fills. Ends ssh in any case.
class Fetched {
public:
    Fetched(const Remote& remote, const std::vector<std::string>& words)
        : out_(opened("fetched.failure")),
          err_(opened("errors")),
          ssh_({.words = remote.command(words), .environment = {}, .out = out_.get(), .err = err_.get()})
    {
    }
    ~Fetched() { ssh_.end(Clock::now() + 1s); }
    Fetched(const Fetched&) = delete;
    Fetched& operator=(const Fetched&) = delete;

    [[nodiscard]] fs::path file() const { return directory_.path() / "fetched.failure"; }
    [[nodiscard]] fs::path errors() const { return directory_.path() / "errors"; }
    CommandResult wait(const FailureQuery& query)
    {
        constexpr auto interval = 20ms;
        const auto end = Clock::now() + query.limit;
        while (!ssh_.await_end(std::min(end, Clock::now() + interval)) && Clock::now() < end) {
            if (query.cancelled && query.cancelled())
                throw Error(Errc::stopped, "cancelled");
            require_size("the failure", file(), event::max_failure_file_bytes);
            require_size("what ssh prints", errors(), max_errors);
        }
        CommandResult result;
        if (const auto status = ssh_.ended())
            result.exit_code = exit_code_of_status(*status);
        else
            result.late = true;
        constexpr std::size_t lines = 50;
        result.err = last_lines(errors(), lines);
        return result;
    }

private:
    static constexpr std::uintmax_t max_errors = 1024 * 1024;

    static void require_size(const std::string& what, const fs::path& file, std::uintmax_t most)
    {
        std::error_code problem;
        const auto size = fs::file_size(file, problem);
        require_done(problem.value(), "read a temporary file");
        require_at_most(what, size, most);
    }

    [[nodiscard]] transport::Descriptor opened(const char* name) const
    {
        transport::Descriptor file(
            ::open((directory_.path() / name).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
        require_done(file ? 0 : errno, "write a temporary file");
        return file;
    }

    OwnDirectory directory_;
    transport::Descriptor out_, err_;
    Child ssh_;
};

KeptFailure on_machine(Application& application, const std::string& ssh, const FailureQuery& query)
{
    const Remote remote(ssh, application.home());
    std::vector<std::string> words{"rerun", require_name(drone_of(query.drone), "drone"), "--save", "-", "--json"};
    if (query.number > 0)
        words.insert(words.begin() + 2, std::to_string(query.number));
    Fetched fetched(remote, words);
    const auto result = fetched.wait(query);
    remote.require_there(result);
    if (result.exit_code != 0)
        throw remote.error_of(result);
    return in_file(fetched.file(), "what " + remote.host() + " sent");
}

/// The ssh host of a drone on another machine; empty: it runs here, or was not started over ssh.
std::string ssh_of(Application& application, const std::string& drone)
try {
    return application.place(drone).ssh;
} catch (const Error&) {
    return {};
}

Error missing(const FailureQuery& query, const std::vector<KeptFailure>& failures)
{
    const auto drone = printable(query.drone);
    if (failures.empty())
        return {Errc::not_found, "no input that " + drone + " failed at is kept here",
                "see what is: hivectl exceptions; kept on another machine: hivectl rerun " + drone + " --on HOST"};
    std::string kept;
    for (const auto& failure : failures)
        kept += (kept.empty() ? "" : ", ") + std::to_string(failure.number);
    return {Errc::not_found, "of " + drone + " no failure " + std::to_string(query.number) + " is kept, but " + kept,
            "see them: hivectl exceptions " + drone};
}

/// Adds what is known of the drone's program. Parameters that affect the machine, such as logins, have no value, since
/// the file may be mailed.
void add_program(Application& application, KeptFailure& failure)
try {
    auto known = known_program(application, failure.drone);
    failure.kind = known.kind;
    const bool runs = std::ranges::binary_search(application.drones(), failure.drone);
    const auto interface = runs ? application.describe(failure.drone) : interface_of(known.kind);
    failure.version = interface.version;
    for (auto& [name, value] : known.parameters.items())
        if (const auto* const parameter = interface.parameter(name); parameter && value != parameter->default_value)
            failure.parameters[name] = parameter->for_operator ? Json() : value;
} catch (const Error&) {
    // It has just exited, or its program is gone: the file is without its parameters.
    failure.version = version();
}

}  // namespace

bool is_failure_file(const std::string& word) { return word.find('/') != word.npos || word.ends_with(extension); }

KeptFailure find_failure(Application& application, const FailureQuery& query)
{
    if (is_failure_file(query.drone))
        return in_file(query.drone, query.drone);
    if (!query.on.empty())
        return on_machine(application, query.on, query);
    auto failures = application.failures(query.drone, true);
    const auto found = query.number == 0 && !failures.empty()
                           ? failures.end() - 1
                           : std::ranges::find(failures, query.number, &KeptFailure::number);
    if (found != failures.end())
        return std::move(*found);
    if (const auto ssh = ssh_of(application, query.drone); !ssh.empty())
        return on_machine(application, ssh, query);
    throw missing(query, failures);
}

std::string failure_file(Application& application, KeptFailure failure)
{
    if (failure.version.empty())
        add_program(application, failure);
    std::ostringstream out;
    event::write_failure(out, failure);
    return std::move(out).str();
}

}  // namespace hive
