// Handles fatal signals on their own stack: a fiber may have exhausted its stack.
#include "crash.hpp"

#include <array>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <unistd.h>

namespace hive::simulation {
namespace {

std::array<char, 400> text;

void die(int signal)
{
    // A failed write cannot be handled here.
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), std::strlen(text.data()));
    ::raise(signal);
}

void install()
{
    static std::array<char, 64 * 1024> own_stack;
    const stack_t stack{.ss_sp = own_stack.data(), .ss_flags = 0, .ss_size = own_stack.size()};
    ::sigaltstack(&stack, nullptr);
    struct sigaction action {};
    action.sa_handler = die;
    action.sa_flags = SA_ONSTACK | static_cast<int>(SA_RESETHAND);
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGALRM, SIGTERM})
        ::sigaction(signal, &action, nullptr);
}

}  // namespace

void say_in_a_crash(const std::string& options)
{
    [[maybe_unused]] static const bool installed = (install(), true);
    std::snprintf(text.data(), text.size(), "ended by a signal; to play it again: scripts/simulate --trace %s\n",
                  options.c_str());
}

}  // namespace hive::simulation
