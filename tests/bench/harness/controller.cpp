// The controller: starts the roles of one run as processes, waits for them, prints the outcome.
#include "outcome.hpp"
#include "roles.hpp"

#include "free_port.hpp"
#include "process.hpp"

#include <csignal>
#include <filesystem>
#include <iostream>
#include <optional>
#include <sys/mman.h>
#include <unistd.h>

namespace hive::bench {
namespace {

namespace fs = std::filesystem;
using test::Milliseconds;
using test::Process;

constexpr auto stragglers_have = Milliseconds(2500);

/// Memory that was free for some seconds may have been given back to the host of a virtual machine, and its first touch
/// then costs faults there; so that no row pays for its predecessor, the free pages are touched before a large run.
void warm_free_memory()
{
    constexpr std::size_t size = 256u << 20;
    void* memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
    if (memory != MAP_FAILED)
        ::munmap(memory, size);
}

class Roles {
public:
    Roles(const Run& run, const Transport& transport) : run_(run), log_("/tmp/" + run.place + ".log")
    {
        if (run.busy)
            load_ = start(Role::load, 0);
        if (transport.answers(run)) {
            main_ = start(Role::server, 0);
            others_.push_back(start(Role::client, 0));
            return;
        }
        main_ = start(Role::publisher, 0);
        for (int i = 0; i < run.subscribers; ++i)
            others_.push_back(start(Role::subscriber, i));
    }

    ~Roles() { fs::remove(log_); }

    /// Did all end well, and in time?
    bool wait()
    {
        const auto timeout = Milliseconds(static_cast<std::int64_t>(run_.timeout * 1000));
        auto well = main_->wait(timeout) == 0;
        for (auto& other : others_)
            well = other.wait(stragglers_have) == 0 && well;
        if (!well)
            std::cerr << "bench_" << run_.program << " " << run_.variant << " " << to_text(run_.test) << " failed\n"
                      << test::text_of(log_);
        return well;
    }

private:
    Process start(Role role, int index) const
    {
        Run run = run_;
        run.role = role;
        run.index = index;
        auto words = words_of(run);
        words.insert(words.begin(), fs::read_symlink("/proc/self/exe"));  // by its name, so that valgrind can follow
        return {words, {}, log_};
    }

    Run run_;
    fs::path log_;
    std::optional<Process> load_, main_;
    std::vector<Process> others_;
};

/// Plays the run; false when it did not end well.
bool play_all(const Transport& transport, const Run& run)
{
    Roles roles(run, transport);
    bool wired = true;
    try {
        transport.wire(run);
    } catch (const std::exception& error) {
        std::cerr << "bench_" << run.program << ": " << error.what() << '\n';
        wired = false;
    }
    return roles.wait() && wired;
}  // whatever still runs is ended here, so that its usage counts

Json control(const Transport& transport, Run run)
{
    const Board& board = make_board();
    run.place = "hive-bench-" + std::to_string(::getpid());
    run.port = test::free_port();
    if (run.size > 1'000'000)
        warm_free_memory();
    transport.prepare(run);
    const double busy = machine_cpu();
    const auto begin = now_ns();
    const bool well = play_all(transport, run);
    const double took = seconds_of(now_ns() - begin);
    transport.clean(run);
    Json json = outcome_of(run, board, well);
    json["foreign"] = std::max(0.0, machine_cpu() - busy - children_usage().cpu - own_usage().cpu) / took;
    json["took"] = took;
    return json;
}

}  // namespace

int row_main(const std::string& program, const Transport& transport, int argc, char** argv)
{
    std::signal(SIGPIPE, SIG_IGN);
    try {
        const Run run = read_run(program, {argv + 1, argv + argc});
        if (run.role != Role::controller) {
            play(transport, run, inherited_board());
            return 0;
        }
        const Json outcome = control(transport, run);
        std::cout << outcome.dump() << std::endl;
        return outcome.at("ok").get<bool>() ? 0 : 1;
    } catch (const std::exception& error) {
        std::cerr << "bench_" << program << ": " << error.what() << '\n';
        return 2;
    }
}

}  // namespace hive::bench
