// A client of the machine's Avahi daemon on a separate thread, so that no other thread waits for D-Bus. Reconnects
// after a restart of the daemon.
#pragma once

#include "avahi.hpp"

#include <chrono>
#include <functional>
#include <memory>
#include <string>

namespace hive::discovery {

/// A user of the daemon. All calls are on that thread, and so are the callbacks of libavahi.
class DaemonUser {
public:
    virtual ~DaemonUser() = default;
    /// The daemon runs. @return whether the work was started; if not, this is called again later
    virtual bool begin(const Avahi& avahi, AvahiClient& client) = 0;
    /// The daemon is gone, or has to be asked again; the client frees all started work after this.
    virtual void lost() = 0;
    /// No daemon is available: no bus, no library, or no daemon.
    virtual void nobody() {}
    /// Every `tick_every` while the work runs. @return as begin()
    virtual bool tick() { return true; }
    /// Has the work ended by itself? Checked after each event.
    [[nodiscard]] virtual bool failed() const { return false; }

    static constexpr std::chrono::milliseconds tick_every{1000};
};

class DaemonThread {
public:
    explicit DaemonThread(std::shared_ptr<DaemonUser> user);
    /// Tells the thread to end, and waits briefly: it may be in a call to a bus that does not answer. Then it keeps
    /// running, with the user object, until that call returns.
    ~DaemonThread();
    DaemonThread(const DaemonThread&) = delete;
    DaemonThread& operator=(const DaemonThread&) = delete;

private:
    struct State;
    static void run(const std::shared_ptr<State>& state);
    static void serve(State& state, const Avahi& avahi);

    std::shared_ptr<State> state_;
};

}  // namespace hive::discovery
