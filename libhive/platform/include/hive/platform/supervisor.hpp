// Who supervises this process, as systemd does, and is told how it is. Chosen at link time, as the clocks are.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace hive::platform {

/// "READY=1", "STATUS=waits for a camera", "WATCHDOG=1": see sd_notify(3). To nobody, where $NOTIFY_SOCKET names none.
void tell_supervisor(const std::string& news) noexcept;
/// How long it may hear no "WATCHDOG=1" before it ends this process; nothing: for ever.
[[nodiscard]] std::optional<std::chrono::microseconds> patience_of_supervisor();

}  // namespace hive::platform
