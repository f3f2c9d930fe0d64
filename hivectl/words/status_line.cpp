#include "words/status_line.hpp"

#include "words/terminal.hpp"

#include <algorithm>
#include <atomic>
#include <unistd.h>
#include <utility>

namespace hivectl {

using namespace std::chrono_literals;

namespace {

std::atomic<bool> on_screen{false}, taken_over{false};
std::mutex printing;

}  // namespace

namespace status_line {

bool possible() { return ::isatty(STDERR_FILENO) == 1 && !is_dumb_terminal(); }

void show(std::string_view text)
{
    if (!possible())
        return;
    const std::lock_guard lock(printing);
    on_screen = true;
    const std::string line = "\r" + shortened(text, columns_of(STDERR_FILENO) - 1) + "\x1b[K";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, line.data(), line.size());
}

void take_over() noexcept
{
    if (!taken_over.exchange(true))
        erase();
}

void erase() noexcept
{
    constexpr std::string_view line = "\r\x1b[K";
    if (on_screen.exchange(false)) [[maybe_unused]]
        const auto written = ::write(STDERR_FILENO, line.data(), line.size());
}

Interruption::Interruption() : lock_(printing) { erase(); }

}  // namespace status_line

std::string names_text(const std::vector<std::string>& names)
{
    constexpr std::size_t max_names = 4;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), max_names); ++i)
        text += (i == 0 ? "" : ", ") + names[i];
    if (names.size() > max_names)
        text += " and " + std::to_string(names.size() - max_names) + " more";
    return names.empty() ? "the swarm" : text;
}

Waiting::Waiting(std::string what, Turn turn) : what_(std::move(what)), turn_(turn)
{
    if (turn == Turn::own)
        status_line::take_over();
    if (status_line::possible())
        thread_ = std::jthread([this](const std::stop_token& end) { run(end); });
}

Waiting::~Waiting()
{
    if (thread_.joinable()) {
        thread_.request_stop();
        thread_.join();
    }
    if (shown_)
        status_line::erase();
}

void Waiting::now_for(std::string what)
{
    const std::lock_guard lock(mutex_);
    if (what == what_)
        return;
    what_ = std::move(what);
    if (shown_)
        show();
}

void Waiting::again()
{
    const std::lock_guard lock(mutex_);
    since_ = Clock::now();
    if (std::exchange(shown_, false))
        status_line::erase();
}

void Waiting::run(const std::stop_token& end)
{
    std::unique_lock lock(mutex_);
    while (!end.stop_requested()) {
        const auto seconds = std::chrono::floor<std::chrono::seconds>(Clock::now() - since_);
        if (seconds >= 1s)
            show();
        changed_.wait_until(lock, end, since_ + seconds + 1s, [] { return false; });
    }
}

void Waiting::show()
{
    if (what_.empty() || (turn_ == Turn::first && taken_over))
        return;
    shown_ = true;
    const auto seconds = std::chrono::floor<std::chrono::seconds>(Clock::now() - since_).count();
    status_line::show("waiting for " + what_ + ", " + std::to_string(seconds) + " s");
}

}  // namespace hivectl
