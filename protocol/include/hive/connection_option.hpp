// One table of the options of a connection, for every reader and writer of their text forms.
#pragma once

#include <hive/json.hpp>
#include <hive/transfer.hpp>

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hive {

/// One option: a key of a swarm file, an option of `hivectl connect`, a keyword in --connect. `share`, which stands for
/// the group of the sender's name, is not among them, since these know no sender.
struct ConnectionOption {
    enum class Type { flag, count, name, duration, encoding };

    std::string_view name;   ///< in a swarm file and in --connect: "first_frame"
    std::string_view field;  ///< in the JSON of the protocol and of C: "lease_ms"
    std::variant<Transfer ConnectionOptions::*, Delivery ConnectionOptions::*, int ConnectionOptions::*,
                 bool ConnectionOptions::*, std::string ConnectionOptions::*,
                 std::optional<std::chrono::milliseconds> ConnectionOptions::*>
        member;
    Type type;
    std::string_view placeholder;  ///< for the value in help texts; empty for a flag
    std::string_view must;         ///< what the value must be: "a whole number from 1 to 64"
    std::string_view help;

    [[nodiscard]] bool is_flag() const noexcept { return type == Type::flag; }
    /// On a command line: "--first-frame".
    [[nodiscard]] std::string on_command_line() const;
    /// The value as in a swarm file: true, 4, "faces", 0.5 for a lease in seconds; null: the lease is measured.
    [[nodiscard]] Json value(const ConnectionOptions& options) const;
    /// The same for a command line: "4", "faces", "0.5".
    [[nodiscard]] std::string text(const ConnectionOptions& options) const;
    /// Does it differ from the default?
    [[nodiscard]] bool is_given(const ConnectionOptions& options) const { return value(options) != value({}); }
    /// False, and nothing is changed, when the value is invalid.
    [[nodiscard]] bool set(ConnectionOptions& options, const Json& value) const;
    [[nodiscard]] bool set_text(ConnectionOptions& options, const std::string& text) const;
};

inline constexpr int widest_window = 64;
inline constexpr double shortest_lease_s = 0.05, longest_lease_s = 86'400;

/// In the order in which swarm files are written.
std::span<const ConnectionOption> connection_option_table();
/// The options that --connect accepts after DRONE.OUTPUT: "at=tcp://HOST:PORT, share, stream, window=N, ...".
std::string connection_option_words();

/// The error of a lease without a group, after the name of the option.
inline constexpr std::string_view for_shared_work = " is for shared work";

/// Two options, possibly "share", that exclude each other.
struct ConnectionClash {
    std::string_view one, other;
};
std::span<const ConnectionClash> connection_clashes();

}  // namespace hive
