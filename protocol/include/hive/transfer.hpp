// The options of a connection, and the enumerations for how events travel.
#pragma once

#include <hive/json.hpp>

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace hive {

/// synchronized: the receiver requests each event and gets the newest at that time. streaming: it registers once and
/// gets every event, through a bounded queue that drops the oldest (paper, section 3.5).
enum class Transfer { synchronized, streaming };
/// data: header and body. notification: the header alone.
enum class Delivery { data, notification };
enum class State { starting, idle, busy, halted, stopping };
/// What happens when a drone's code throws: skip abandons the input, halt accepts nothing until resumed.
enum class ExceptionPolicy { skip, halt };

std::string_view token(Transfer value) noexcept;         // "sync", "stream"
std::string_view token(Delivery value) noexcept;         // "data", "notify"
std::string_view token(State value) noexcept;            // "idle"
std::string_view token(ExceptionPolicy value) noexcept;  // "skip", "halt"

/// The enumerator of a token; throws Errc::malformed, which names `what` and the valid tokens.
template <class Enum>
Enum from_token(std::string_view text, std::string_view what);

struct ConnectionOptions {
    Transfer transfer = Transfer::synchronized;
    Delivery delivery = Delivery::data;
    int window = 1;            ///< requests outstanding at once, 1 to 64; streaming has no window
    std::string group = {};    ///< not empty: the receivers of this group share the events, one each
    bool first_frame = false;  ///< start with the newest existing event; not in a group
    /// How long a member of a group may work on one event before another gets it. Empty: 30 s until the sender has
    /// measured the work, then four times that, at least 2 s.
    std::optional<std::chrono::milliseconds> lease = {};
    /// How bodies are encoded, see encoding.hpp. Empty: unencoded on one machine, the output's preferred encoding
    /// across a network.
    std::string encoding = {};

    bool operator==(const ConnectionOptions&) const = default;
};

Json to_json(const ConnectionOptions& options);
/// Reads what to_json wrote; absent fields have their defaults. Throws Errc::malformed.
ConnectionOptions connection_options(const Json& object);

/// Do the types that an output emits and those that an input accepts overlap? Each is a comma-separated list of media
/// types in which `*` may stand for a part: "image/jpeg", "image/*", "*/*".
bool types_fit(std::string_view output_types, std::string_view input_types);

}  // namespace hive
