// Reports the state of this process to its supervisor, such as systemd. Chosen at link time, as the clocks are.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace hive::platform {

/// "READY=1", "STATUS=waits for a camera", "WATCHDOG=1": see sd_notify(3). Does nothing without $NOTIFY_SOCKET.
void tell_supervisor(const std::string& news) noexcept;
/// How long the supervisor waits for the next "WATCHDOG=1" before it kills this process; nothing: forever.
[[nodiscard]] std::optional<std::chrono::microseconds> supervisor_timeout();

}  // namespace hive::platform
