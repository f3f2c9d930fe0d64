// A client of the machine's Avahi daemon on a thread of its own: nobody waits for D-Bus, and a daemon that restarts is
// found again.
#pragma once

#include "avahi.hpp"

#include <chrono>
#include <functional>
#include <memory>
#include <string>

namespace hive::discovery {

/// What is wanted of the daemon. All on that thread; libavahi calls nothing here at any other time.
class DaemonUser {
public:
    virtual ~DaemonUser() = default;
    /// The daemon runs. @return whether what is wanted could be begun; if not, it is tried again in a while
    virtual bool begin(const Avahi& avahi, AvahiClient& client) = 0;
    /// The daemon is gone, or has to be told anew; what was begun ends with the client, after this.
    virtual void lost() = 0;
    /// There is nobody to be asked: no bus, no library, no daemon.
    virtual void nobody() {}
    /// Every `tick_every` while it is begun. @return as of begin()
    virtual bool tick() { return true; }
    /// Has it ended by itself? Asked after everything that came.
    [[nodiscard]] virtual bool failed() const { return false; }

    static constexpr std::chrono::milliseconds tick_every{1000};
};

class DaemonThread {
public:
    explicit DaemonThread(std::shared_ptr<DaemonUser> user);
    /// Tells the thread to end, and waits for that a moment: it may be in a call to a bus that does not answer, in
    /// which case it goes on alone, with the user, until that call has ended.
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
