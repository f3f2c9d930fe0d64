// The levels of a drone's log.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>

namespace hive {

/// error: a drone's code threw or failed. warning: a refusal, a lost connection, a key or a saved value that cannot be
/// used. info: starting, listening, stopping, being replaced. debug: connections made, and links opened and closed
/// normally.
enum class LogLevel { debug, info, warning, error };

inline constexpr std::array<std::string_view, 4> log_levels{"debug", "info", "warning", "error"};
inline std::string_view token(LogLevel level) { return log_levels.at(static_cast<std::size_t>(level)); }

/// Writes one line of a log.
using Log = std::function<void(LogLevel, const std::string&)>;

}  // namespace hive
