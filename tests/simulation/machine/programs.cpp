// Programs and processes of this machine; there is no other one to start them on.
#include "programs.hpp"

#include "child.hpp"
#include "engines/engine.hpp"

#include <hive/error.hpp>
#include <hive/program.hpp>
#include <hive/remote.hpp>

#include <csignal>

namespace hive {

using namespace std::chrono_literals;
using simulation::programs;
using simulation::world;

simulation::Programs& simulation::programs()
{
    static Programs all;
    return all;
}

// --- processes ---

Child::Child(const ChildProgram& program) : pid_(static_cast<pid_t>(programs().start(program.words).pid)) {}
Child::~Child() = default;
Child::Child(Child&& other) noexcept : pid_(other.pid_), status_(other.status_) {}

Child& Child::operator=(Child&& other) noexcept
{
    std::swap(pid_, other.pid_);
    std::swap(status_, other.status_);
    return *this;
}

int Child::descriptor() { return ended() ? -1 : 0; }
bool Child::leads(std::int64_t pid) const { return pid == pid_; }

std::optional<int> Child::ended()
{
    if (const auto* process = world().process(pid_); process && process->dead)
        status_ = process->status;
    return status_;
}

bool Child::await_end(Clock::time_point until)
{
    while (!ended() && Clock::now() < until)
        world().sleep(1ms);
    return ended().has_value();
}

/// It has no signal handler yet.
void Child::terminate()
{
    if (!ended())
        world().kill(std::int64_t{pid_});
}

void Child::end(Clock::time_point until)
{
    terminate();
    await_end(until);
}

void require_done(int error, const std::string& what)
{
    if (error != 0)
        throw Error(Errc::io, "cannot " + what);
}

// --- programs ---

std::optional<std::filesystem::path> program_of(const std::string& kind) { return kind; }
DroneCommand command_of(const std::string& kind) { return {.program = kind, .arguments = {}, .environment = {}}; }
Interface interface_of(const std::string& kind, std::chrono::milliseconds) { return programs().describe(kind); }
std::string usual_name(const std::string& kind) { return kind; }
std::optional<std::string> kind_by_name(const std::string&) { return std::nullopt; }
bool is_python_file(const std::string&) { return false; }
bool is_of_kind(const Status& running, const std::string& kind) { return running.kind == kind; }

// --- other machines ---

namespace {

[[noreturn]] void fail() { throw Error(Errc::unsupported, "no ssh in a simulated world"); }

}  // namespace

Remote::Remote(std::string, const std::filesystem::path&) { fail(); }
std::string Remote::host() const { fail(); }
std::unique_ptr<Engine> make_ssh_engine(const Json&, const std::filesystem::path&) { fail(); }

}  // namespace hive
