// Connects to the daemon, and reconnects after a delay.
#include "daemon_thread.hpp"

#include <hive/platform/crash_signals.hpp>

#include <condition_variable>
#include <mutex>
#include <thread>

namespace hive::discovery {
namespace {

using namespace std::chrono_literals;

constexpr auto again_after = 500ms;    ///< when the daemon was lost
constexpr auto look_again_after = 5s;  ///< when no daemon is available
constexpr auto shutdown_timeout = 200ms;

}  // namespace

struct DaemonThread::State {
    /// @return whether the thread has to end
    bool sleep(std::chrono::milliseconds time)
    {
        std::unique_lock lock(mutex);
        return changed.wait_for(lock, time, [&] { return ending; });
    }
    bool is_ending()
    {
        const std::lock_guard lock(mutex);
        return ending;
    }

    void may_wake(const Avahi* library, AvahiSimplePoll* its_poll)
    {
        const std::lock_guard lock(mutex);
        avahi = library;
        poll = its_poll;
    }

    std::shared_ptr<DaemonUser> user;
    std::mutex mutex;
    std::condition_variable changed;
    bool ending = false, ended = false;
    const Avahi* avahi = nullptr;     ///< with the poll
    AvahiSimplePoll* poll = nullptr;  ///< wakes the thread
};

DaemonThread::DaemonThread(std::shared_ptr<DaemonUser> user) : state_(std::make_shared<State>())
{
    state_->user = std::move(user);
    const platform::SignalsBlocked blocked;
    std::thread([state = state_] { run(state); }).detach();
}

DaemonThread::~DaemonThread()
{
    std::unique_lock lock(state_->mutex);
    state_->ending = true;
    if (state_->poll)
        state_->avahi->simple_poll_wakeup(state_->poll);
    state_->changed.notify_all();
    state_->changed.wait_for(lock, shutdown_timeout, [&] { return state_->ended; });
}

void DaemonThread::run(const std::shared_ptr<State>& state)
{
    std::chrono::milliseconds pause{};
    do {
        const auto* library = has_system_bus() ? avahi() : nullptr;
        if (library)
            serve(*state, *library);
        else
            state->user->nobody();
        pause = library ? again_after : look_again_after;
    } while (!state->sleep(pause));
    const std::lock_guard lock(state->mutex);
    state->ended = true;
    state->changed.notify_all();
}

namespace {

struct PollFree {
    const Avahi* avahi;
    void operator()(AvahiSimplePoll* poll) const { avahi->simple_poll_free(poll); }
};
using Poll = std::unique_ptr<AvahiSimplePoll, PollFree>;

struct ClientFree {
    const Avahi* avahi;
    void operator()(AvahiClient* client) const { avahi->client_free(client); }
};

/// The state of the daemon, as reported to its client.
struct Standing {
    const Avahi& avahi;
    DaemonUser& user;
    bool connected = false, lost = false;
};

void on_state(AvahiClient* client, AvahiClientState now, void* data)
{
    auto& standing = *static_cast<Standing*>(data);
    if (now == AVAHI_CLIENT_S_RUNNING && !standing.connected) {
        standing.connected = true;
        standing.lost = !standing.user.begin(standing.avahi, *client);
    } else if (now == AVAHI_CLIENT_CONNECTING && !standing.connected) {
        standing.user.nobody();
    } else if (now == AVAHI_CLIENT_FAILURE || standing.connected) {
        standing.lost = true;  // it exits, or its host name changes: restarts the work
    }
}

}  // namespace

/// Runs one client, until it is lost or the thread has to end.
void DaemonThread::serve(State& state, const Avahi& avahi)
{
    const Poll poll(avahi.simple_poll_new(), PollFree{&avahi});
    if (!poll)
        return state.user->nobody();
    Standing standing{avahi, *state.user};
    const auto flags = static_cast<AvahiClientFlags>(AVAHI_CLIENT_NO_FAIL | AVAHI_CLIENT_IGNORE_USER_CONFIG);
    const std::unique_ptr<AvahiClient, ClientFree> client(
        avahi.client_new(avahi.simple_poll_get(poll.get()), flags, on_state, &standing, nullptr), ClientFree{&avahi});
    if (!client)
        return state.user->nobody();
    state.may_wake(&avahi, poll.get());
    auto tick_at = std::chrono::steady_clock::now() + DaemonUser::tick_every;
    while (!standing.lost && !state.user->failed() && !state.is_ending()) {
        if (avahi.simple_poll_iterate(poll.get(), static_cast<int>(DaemonUser::tick_every / 1ms)) != 0)
            break;
        if (std::chrono::steady_clock::now() < tick_at)
            continue;
        tick_at += DaemonUser::tick_every;
        if (standing.connected && !standing.lost && !state.user->tick())
            break;
    }
    state.may_wake(nullptr, nullptr);
    state.user->lost();
}

}  // namespace hive::discovery
